// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tools: what a click asks, and how the answer is written and drawn.
import type { MapPosition } from 'ptin-decoder';
import type { Sight, Station } from './answers';
import { drawnSight } from './drawn_sight';
import { bound, coordinates, count, height as heightText, interval, length as lengthText, metres, number, roundBelow, rounded, signOf } from './format';
import type { Frame } from './frame';
import type { Answer, Certainty, FromWorker, Question, ToWorker } from './messages';
import { colour, download, hide, part, speak, toast } from './page';
import type { AskedLink } from './permalink';
import { csvOf, drawPlot } from './plot';
import type { Projected } from './projected';
import type { Place, Relief } from './relief';
import { recoloured } from './seen';
import { climbOf, extentOf, heightAlong, heightsOf, runsOf } from './stations';

export type Tool = 'height' | 'profile' | 'area' | 'sight' | 'viewshed';
type AnswerOf<K extends Answer['kind']> = Extract<Answer, { kind: K }>;
type AlongLine = AnswerOf<'profile'> | AnswerOf<'sight'>;

/** Parts of the page that the tools use. */
export interface Ground {
  relief: Relief;
  frame(): Frame | null;
  send(message: ToWorker): void;
  /** Where a place of the scene is in the picture. */
  project(place: Place): Projected;
  /** Moves the camera: shares of the picture to the right and ahead, or away by a factor. */
  pan(right: number, ahead: number): void;
  zoom(factor: number): void;
  /** The question has changed. */
  changed(): void;
}

/** A field of a tool's form. Each is sent. */
interface Field {
  name: string;
  label: string;
  unit: string;
  value: number | '';
}

const eyeFields: readonly Field[] = [
  { name: 'observer', label: 'Eye', unit: 'm', value: 2 }, { name: 'target', label: 'Target', unit: 'm', value: 2 },
];
const titles: Record<Tool, string> = {
  height: 'Height', profile: 'Profile', area: 'Area', sight: 'Line of sight', viewshed: 'Viewshed',
};
const hints: Record<Tool, string> = {
  height: 'Click the terrain for its height', profile: 'Click where the profile begins, then where it ends',
  area: 'Click the corners of the area', sight: 'Click the eye, then the target', viewshed: 'Click where the observer stands',
};
/** Points without which nothing is asked, and the most that there may be: a further click begins anew. */
const fewest: Record<Tool, number> = { height: 1, profile: 2, area: 3, sight: 2, viewshed: 1 };
const most: Record<Tool, number> = { height: 1, profile: 1000, area: 1000, sight: 2, viewshed: 1 };

export class Inquiry {
  private tool: Tool = 'height';
  private places: MapPosition[] = [];
  private asked: Question | null = null;
  private ticket = 0;
  private shownProfile: AlongLine | null = null;
  /** Places of the scene, which the answer should not cover. */
  private spoken: Place[] = [];

  private readonly relief: Relief;
  private readonly frame: () => Frame | null;

  constructor(private readonly ground: Ground) {
    this.relief = ground.relief;
    this.frame = () => ground.frame();
    for (const radio of document.querySelectorAll<HTMLInputElement>('input[name=tool]')) {
      radio.addEventListener('change', () => { this.choose(radio.value as Tool); });
    }
    part('answer-close').addEventListener('click', () => { this.close(); });
    part('csv').addEventListener('click', () => { this.saveProfile(); });
    part<HTMLFormElement>('sight-form').addEventListener('input', () => { this.askAgain(); });
    part<HTMLFormElement>('sight-form').addEventListener('submit', (event) => { event.preventDefault(); });
    addEventListener('resize', () => { if (this.shownProfile !== null) this.plot(this.shownProfile); });
  }

  choose(tool: Tool): void {
    this.takeUp(tool);
    if (tool === 'height' || tool === 'profile') toast(hints[tool]);
    else this.showForm(hints[tool]);
  }

  private takeUp(tool: Tool): void {
    this.close();
    this.tool = tool;
    document.querySelector<HTMLInputElement>(`input[name=tool][value=${tool}]`)!.checked = true;
    this.makeForm(tool);
  }

  /** The question, as a link has it. */
  get link(): AskedLink | null {
    if (this.asked === null || (this.asked.kind === 'profile' && this.asked.isLonLat === true)) return null;
    return { tool: this.tool, places: this.places, values: this.fields.map((f) => this.formValue(f.name)) };
  }

  /** Asks what a link asks. */
  follow({ tool, places, values }: AskedLink): void {
    if (tool === 'viewshed' && part('viewshed-tool').hidden) return;
    this.choose(tool);
    this.fields.forEach((f, i) => { if (values[i] !== undefined) this.formField(f.name).value = String(values[i]); });
    this.places = places;
    this.askIfEnough();
  }

  /** A profile along a line that came from elsewhere. */
  profileAlong(line: MapPosition[], isLonLat: boolean): void {
    this.takeUp('profile');
    this.places = line;
    const [from, ...rest] = line;
    this.ask({ kind: 'profile', from, to: rest[rest.length - 1], via: rest.slice(0, -1), isLonLat });
  }

  /** The form of a tool, before there is an answer. */
  private showForm(hint: string): void {
    this.write(titles[this.tool], '', hint);
    this.layOut(false);
  }

  private get fields(): readonly Field[] {
    const { tool } = this;
    if (tool === 'sight') return [...eyeFields, { name: 'frequency', label: 'Radio', unit: 'GHz', value: '' }];
    if (tool === 'viewshed') return [...eyeFields, { name: 'radius', label: 'Radius', unit: 'km', value: this.usualRadius }];
    const frame = this.frame();
    if (tool !== 'area' || frame === null || part('viewshed-tool').hidden) return [];
    return [{ name: 'against', label: 'Volume above', unit: signOf(frame.units.height), value: rounded(frame.facts.minHeight, 4) }];
  }

  /** Kilometres, of so few of a raster's own pixels that a service looks at all of them, and a part of any terrain. */
  private get usualRadius(): number {
    const frame = this.frame();
    return frame === null ? 5 : Math.min(5, roundBelow(Math.max(150 * frame.facts.stepX * frame.scaleX, 0.02 * frame.width) / 1000));
  }

  private makeForm(tool: Tool): void {
    part('sight-form').replaceChildren(...this.fields.map((field) => {
      const label = document.createElement('label'), name = document.createElement('span'), box = document.createElement('span');
      const input = document.createElement('input'), unit = document.createElement('i');
      Object.assign(input, { name: field.name, type: 'number', step: 'any', value: String(field.value) });
      if (tool !== 'area') input.min = '0';
      if (field.value === '') input.placeholder = 'none';
      label.className = 'field';
      box.className = 'with-unit';
      name.textContent = field.label;
      unit.textContent = field.unit;
      box.append(input, unit);
      label.append(name, box);
      return label;
    }));
  }

  /** Shows the parts of the answer that there are. */
  private layOut(hasProfile: boolean): void {
    const wasHidden = part('answer').hidden;
    hide(false, 'answer');
    hide(part('sight-form').childElementCount === 0, 'sight-form');
    hide(!hasProfile, 'csv', 'plot');
    hide(true, 'seen-legend');
    if (wasHidden && hasProfile) part<HTMLDetailsElement>('settings').open = false;
  }

  /** Forgets what was asked, with its marks. */
  close(): void {
    const hasFocus = part('answer').contains(document.activeElement);
    this.places = [];
    this.asked = null;
    this.shownProfile = null;
    this.spoken = [];
    ++this.ticket;
    hide(true, 'answer');
    this.relief.clearMarks();
    this.relief.setDrape(null, []);
    if (hasFocus) this.relief.canvas.focus();
    this.ground.changed();
  }

  /** A click on the terrain. */
  click(place: Place | null): void {
    const frame = this.frame();
    if (frame === null) return;
    if (place === null) {
      toast('There is no terrain at that place');
      return;
    }
    const { places } = this;
    if (places.length >= most[this.tool] || places.length === 0) {
      this.close();
      if (this.fields.length !== 0) this.showForm('');
    }
    this.places = [...this.places, { x: frame.mapX(place.x), y: frame.mapY(place.y) }];
    if (this.askIfEnough()) return;
    this.relief.addMark(place, colour('mark'));
    if (this.tool === 'sight') this.showForm('Now click the target');
    else toast(this.tool === 'area' ? 'Now click the next corner' : 'Now click where it ends');
  }

  /** Takes the last point back; what is left is asked anew. */
  back(): void {
    const left = this.places.slice(0, -1);
    if (left.length >= fewest[this.tool]) {
      this.places = left;
      this.askIfEnough();
    } else {
      this.close();
    }
  }

  /** An answer of the Worker, or its refusal. Those to earlier questions are left alone. */
  take(message: Extract<FromWorker, { kind: 'answer' | 'refused' }>): void {
    if (message.ticket !== this.ticket) return;
    if (message.kind === 'refused') {
      this.shownProfile = null;
      this.write(titles[this.tool], 'No answer', message.message);
      this.layOut(false);
      return;
    }
    const frame = this.frame();
    if (frame !== null) void this.show(message.answer, frame);
  }

  private ask(question: Question): void {
    this.asked = question;
    this.ground.send({ kind: 'ask', ticket: ++this.ticket, question });
    this.ground.changed();
  }

  /** Asks with the places that there are; false where they are too few. */
  private askIfEnough(): boolean {
    const { tool, places, formValue: value } = this;
    if (places.length < fewest[tool]) return false;
    const [from] = places, to = places[places.length - 1];
    const heights = { observerHeight: value('observer'), targetHeight: value('target') };
    switch (tool) {
      case 'height': this.ask({ kind: 'height', at: from }); break;
      case 'profile': this.ask({ kind: 'profile', from, to, via: places.slice(1, -1) }); break;
      case 'area': this.ask({ kind: 'area', ring: places, against: value('against') }); break;
      case 'sight': this.ask({ kind: 'sight', from, to, request: { ...heights, frequency: value('frequency') * 1e9 } }); break;
      case 'viewshed': this.ask({ kind: 'viewshed', at: from, ...heights, radius: value('radius') * 1000 }); break;
    }
    return true;
  }

  private formField(name: string): HTMLInputElement {
    return part<HTMLFormElement>('sight-form').elements.namedItem(name) as HTMLInputElement;
  }

  private readonly formValue = (name: string): number => {
    const value = Number((this.formField(name) as HTMLInputElement | null)?.value ?? 0) || 0;
    return name === 'against' ? value : Math.max(0, value);
  };

  /** The same places with what the form says now. */
  private askAgain(): void {
    if (this.asked !== null) this.askIfEnough();
  }

  private async show(answer: Answer, frame: Frame): Promise<void> {
    this.relief.clearMarks();
    this.spoken = [];
    this.shownProfile = answer.kind === 'profile' || answer.kind === 'sight' ? answer : null;
    this.layOut(this.shownProfile !== null);
    if (answer.kind === 'height') this.showHeight(answer, frame);
    if (answer.kind === 'profile') this.showProfile(answer, frame);
    if (answer.kind === 'area') this.showArea(answer, frame);
    if (answer.kind === 'sight') this.showSight(answer, frame);
    if (answer.kind === 'viewshed') await this.showViewshed(answer, frame);
    this.uncover();
  }

  /** Moves the camera until the answer lies over nothing that it speaks of. */
  private uncover(): void {
    for (let step = 0; step < 12 && this.spoken.length !== 0; ++step) {
      const box = part('answer').getBoundingClientRect();
      const places = this.spoken.map((p) => this.ground.project(p)).filter((p) => p.visible);
      if (!places.some((p) => p.x > box.left && p.x < box.right + 12 && p.y > box.top - 12 && p.y < box.bottom)) return;
      const isSheet = box.width > innerWidth / 2;
      const [low, high] = extentOf(places.map((p) => (isSheet ? p.y : p.x)));
      const room = isSheet ? box.top : innerWidth - box.right;
      if (high - low > 0.8 * room) this.ground.zoom(1.25);
      else this.ground.pan(isSheet ? 0 : -0.6, isSheet ? -0.6 : 0);
    }
  }

  private write(title: string, text: string, note: string, tone = ''): void {
    part('answer-title').textContent = title;
    const strong = document.createElement('span');
    strong.textContent = text;
    strong.className = tone;
    part('answer-text').replaceChildren(strong);
    part('answer-note').textContent = note;
    speak(`${title}: ${text}. ${note}`);
  }

  /** For programs that drive the page: the numbers of the answer as they came. */
  private tell(numbers: Record<string, string | number | null>): void {
    const { dataset } = part('answer');
    for (const key of Object.keys(dataset)) delete dataset[key];
    for (const [key, value] of Object.entries(numbers)) if (value !== null) dataset[key] = String(value);
  }

  private showHeight(answer: AnswerOf<'height'>, frame: Frame): void {
    const { located, certainty, at } = answer;
    const sign = signOf(frame.units.height);
    const where = frame.where(at);
    const { height, least, most } = located;
    this.tell({ x: at.x, y: at.y, height, least, most, error: certainty.error, deviation: certainty.deviation });
    if (located.state !== 'surface' || height === null) {
      this.write('Height', located.state === 'void' ? 'A void: no data here' : 'Outside of the terrain', where);
    } else {
      const isExact = certainty.isExact || least === null || most === null || least === most;
      const [low, high] = isExact ? ['', ''] : interval(least, most, sign);
      const told = isExact ? exactly(certainty) : `certainly between ${low} and ${high}`;
      const cost = answer.cost ? `\n${answer.cost}` : '';
      this.write('Height', heightText(height, isExact ? 0 : (most - least) / 2, sign), `${told}\n${where}${cost}`);
      this.relief.addMark(this.placeOf(frame, at, height), colour('mark'));
    }
    this.spoken = [this.placeOf(frame, at, height ?? frame.baseHeight)];
    const corners = located.triangle.map((c): Place => this.placeOf(frame, c, c.height ?? height ?? frame.baseHeight));
    if (corners.length === 3) {
      this.relief.addLine([...corners, corners[0]], colour('mark'));
      this.relief.addBody(corners, [0, 1, 2], colour('mark'));
    }
  }

  private showProfile(answer: AnswerOf<'profile'>, frame: Frame): void {
    const sign = signOf(frame.units.height);
    const { profile, certainty } = answer;
    const { stations, length, lengths } = profile;
    const known = heightsOf(stations);
    this.tell({
      length, unit: lengths.unit, metres: lengths.metres === null ? null : length * lengths.metres, deviation: certainty.deviation,
    });
    if (known.length === 0) {
      this.write('Profile', 'No data along this line', lengthText(length, lengths));
      hide(true, 'csv', 'plot');
      return;
    }
    const d = slackOf(certainty) ?? Infinity;
    const [low, high] = extentOf(known);
    const climb = climbOf(stations);
    this.write('Profile', lengthText(length, lengths),
      `between ${heightText(low, d, sign)} and ${heightText(high, d, sign)}, up ${number(climb.up, 3)} ${sign}, ` +
      `down ${number(climb.down, 3)} ${sign}\n${certaintyNote(certainty, sign)}`);
    if (answer.isLonLat !== true || frame.isDegrees) this.drawGround(answer, frame, colour('mark'));
    this.plot(answer);
  }

  private showArea(answer: AnswerOf<'area'>, frame: Frame): void {
    const { measured: { surface, empty, cut, fill, unit }, ring, against, certainty } = answer;
    const sign = signOf(frame.units.height);
    const area = (value: number): string => areaText(value, unit);
    this.tell({ surface, empty, unit, cut: cut?.volume ?? null, fill: fill?.volume ?? null, against });
    const notes = [`in plan${empty > 0 ? `, and ${area(empty)} of voids` : ''}`];
    for (const [volume, where] of [[cut, 'above'], [fill, 'missing below']] as const) {
      if (volume === null) continue;
      const [low, high] = [volume.low, volume.high].map((v) => number(v, 5));
      notes.push(`${number(volume.volume, 5)} cubic ${unit} ${where} ${number(against, 5)} ${sign}` +
        (low === high ? '' : `, certainly ${low} to ${high}`));
    }
    if (cut === null) notes.push('Volumes need a service that has /volume.');
    else notes.push(certaintyNote(certainty, sign));
    this.write('Area', area(surface), notes.join('\n'));
    const border = [...ring, ring[0]].flatMap((a, i, all) => {
      const b = all[i + 1];
      return b === undefined ? [] : Array.from({ length: 24 }, (_, k) => this.onGround(frame, {
        x: a.x + k / 24 * (b.x - a.x), y: a.y + k / 24 * (b.y - a.y),
      }));
    });
    this.relief.addLine([...border, border[0]], colour('mark'));
    for (const p of ring) this.relief.addMark(this.onGround(frame, p), colour('mark'), 11);
    this.spoken = border;
  }

  /** A place on the picture's ground: for drawings alone. */
  private onGround(frame: Frame, at: MapPosition): Place {
    const x = frame.sceneX(at.x), y = frame.sceneY(at.y);
    return { x, y, z: this.relief.groundAt(x, y) ?? 0 };
  }

  private showSight(answer: AnswerOf<'sight'>, frame: Frame): void {
    const { sight, request, certainty, from, to } = answer;
    const { verdict, clearance, fresnel } = sight;
    const inMetres = (value: number): number => value * frame.scaleZ;
    this.tell({
      fromX: from.x, fromY: from.y, toX: to.x, toY: to.y,
      verdict, length: sight.length, metres: inMetres(sight.length), clearanceMin: clearance?.min ?? null,
      clearanceMax: clearance?.max ?? null, fresnel: fresnel?.ratio ?? null,
    });
    if (verdict === 'undefined') {
      this.write('Line of sight', 'An end has no ground', 'Choose two places on the surface.');
      hide(true, 'csv', 'plot');
      this.drawGround(answer, frame, colour('soft'));
      return;
    }
    const tone = { visible: 'good', hidden: 'bad', unsure: 'unsure' }[verdict];
    const said = { visible: 'Visible', hidden: 'Hidden', unsure: 'Too close to call' }[verdict];
    const notes = [metres(inMetres(sight.length))];
    if (clearance !== null) {
      notes[0] += `; the line ${clearanceNote(inMetres(clearance.min), inMetres(clearance.max))} at ${metres(inMetres(clearance.at.distance))}`;
    }
    if (fresnel !== null) {
      const share = Math.round(100 * fresnel.ratio);
      notes.push(`First Fresnel zone${certainty.isExact ? '' : ' over the mesh'}: ${share >= 60 ? 'free enough' : 'obstructed'}, ` +
        `${Math.max(0, Math.min(100, share))} % free at ${metres(inMetres(fresnel.at.distance))}`);
    }
    notes.push(certaintyNote(certainty, signOf(frame.units.height)));
    this.write('Line of sight', said, notes.join('\n'), tone);
    this.drawGround(answer, frame, colour('soft'));
    this.drawRay(answer, frame);
    this.plot(answer);
    if (request.frequency > 0) this.drawFresnel(answer, frame);
  }

  private async showViewshed(answer: AnswerOf<'viewshed'>, frame: Frame): Promise<void> {
    const { viewshed, at, observerHeight, targetHeight } = answer;
    const place = this.onGround(frame, at);
    this.relief.addMark(place, colour('mark'), 17);
    this.spoken = [place];
    this.relief.setDrape(await recoloured(viewshed.picture), viewshed.window);
    hide(false, 'seen-legend');
    this.write('Viewshed', metres(answer.radius),
      `around ${coordinates(at.x, at.y, frame.isDegrees)}: the eye ${metres(observerHeight)}, what is looked for ${metres(targetHeight)} above ground`);
  }

  private placeOf(frame: Frame, at: MapPosition, height: number): Place {
    return { x: frame.sceneX(at.x), y: frame.sceneY(at.y), z: frame.sceneZ(height) };
  }

  /** A place on the way. */
  private along(frame: Frame, answer: { from: MapPosition; to: MapPosition }, share: number, height: number): Place {
    const { from, to } = answer;
    return this.placeOf(frame, { x: from.x + share * (to.x - from.x), y: from.y + share * (to.y - from.y) }, height);
  }

  private drawGround(answer: AlongLine, frame: Frame, lineColour: string): void {
    const placeOf = (s: Station): Place => this.placeOf(frame, s, s.height as number);
    this.spoken = runsOf(answer.profile.stations).flatMap((run) => run.map(placeOf));
    for (const run of runsOf(answer.profile.stations)) this.relief.addLine(run.map(placeOf), lineColour);
    const known = answer.profile.stations.filter((s) => s.height !== null);
    for (const s of [known[0], known[known.length - 1]]) if (s !== undefined) this.relief.addMark(placeOf(s), colour('mark'), 11);
  }

  private drawRay(answer: AnswerOf<'sight'>, frame: Frame): void {
    const { at } = drawnSight(answer, frame);
    const { sight, profile } = answer;
    const ray = Array.from({ length: 65 }, (_, i) => this.along(frame, answer, i / 64, at(i / 64)));
    this.relief.addLine(ray, verdictColour(sight.verdict));
    if (sight.verdict === 'visible' || sight.clearance === null) return;
    const closest = sight.clearance.at;
    const ground = heightAlong(profile.stations, closest.distance / sight.length * profile.length);
    if (ground !== null) this.relief.addMark(this.placeOf(frame, closest, ground), verdictColour('hidden'), 17);
  }

  /** The zone as a tube of twelve sides. */
  private drawFresnel(answer: AnswerOf<'sight'>, frame: Frame): void {
    const { at, radius: zone } = drawnSight(answer, frame);
    const { sight, from, to } = answer;
    const dx = frame.sceneX(to.x) - frame.sceneX(from.x), dy = frame.sceneY(to.y) - frame.sceneY(from.y);
    const length = Math.hypot(dx, dy);
    const sides = 12, rings = 48;
    const places: Place[] = [];
    const corners: number[] = [];
    for (let i = 0; i <= rings; ++i) {
      const middle = this.along(frame, answer, i / rings, at(i / rings));
      const radius = zone(i / rings) * frame.scaleZ;
      for (let k = 0; k < sides; ++k) {
        const angle = 2 * Math.PI * k / sides;
        const aside = radius * Math.cos(angle);
        places.push({ x: middle.x - aside * dy / length, y: middle.y + aside * dx / length, z: middle.z + radius * Math.sin(angle) });
        const a = i * sides + k, b = i * sides + (k + 1) % sides;
        if (i < rings) corners.push(a, b, a + sides, b, b + sides, a + sides);
      }
    }
    this.relief.addBody(places, corners, verdictColour(sight.verdict));
  }

  private plot(answer: AlongLine): void {
    const frame = this.frame();
    if (frame === null || part('plot').hasAttribute('hidden')) return;
    const { profile, certainty } = answer;
    const ray = answer.kind === 'sight' ? { ...drawnSight(answer, frame), colour: verdictColour(answer.sight.verdict) } : undefined;
    drawPlot(part('plot') as unknown as SVGSVGElement, {
      profile, heightSign: signOf(frame.units.height), deviation: slackOf(certainty) ?? Infinity, ray,
    });
  }

  private saveProfile(): void {
    const { shownProfile: p } = this;
    if (p === null) return;
    download('profile.csv', csvOf(p.profile, slackOf(p.certainty)), 'text/csv');
  }
}

/** The colours of marks, which follow light and dark. */
function verdictColour(verdict: Sight['verdict']): string {
  return colour({ visible: 'good', hidden: 'bad', unsure: 'unsure', undefined: 'soft' }[verdict]);
}

function exactly(certainty: Certainty): string {
  return certainty.of === 'terrain' ? 'exact, of the full terrain' : 'exact';
}

/** How far the full terrain may be from a height that is told; null: not known. */
function slackOf(certainty: Certainty): number | null {
  return certainty.isExact ? 0 : certainty.deviation;
}

function certaintyNote(certainty: Certainty, sign: string): string {
  if (certainty.isExact) return `Heights ${exactly(certainty)}`;
  if (certainty.deviation === null) return 'Heights are not certified here';
  return `Heights within \u00b1${bound(certainty.deviation)} ${sign}` +
    (certainty.of === 'terrain' ? ' of the source' : ' of the full terrain');
}

/** A note on the line above the ground, from `min` to `max` metres. */
function clearanceNote(min: number, max: number): string {
  const told = (a: number, b: number): string => {
    const [low, high] = [Math.min(a, b), Math.max(a, b)];
    return number(low, 3) === number(high, 3) ? `${number(low, 3)} m` : `${number(low, 3)} to ${number(high, 3)} m`;
  };
  if (min >= 0) return Number.isFinite(max) ? `clears the ground by ${told(min, max)}` : `clears the ground by ${number(min, 3)} m or more`;
  if (max < 0) return `is blocked by ${told(-max, -min)}`;
  return `is between ${number(-min, 3)} m below and ${Number.isFinite(max) ? `${number(max, 3)} m` : 'any height'} above the ground`;
}

/** An area in squares of a unit; of metres in the usual ones. */
export function areaText(value: number, unit: string): string {
  if (unit !== 'metre') return `${number(value, 4)} square ${unit}`;
  if (value >= 1e6) return `${number(value / 1e6, 4)} km\u00b2`;
  return value >= 1e5 ? `${number(value / 1e4, 4)} ha` : `${value >= 1e4 ? count(value) : number(value, 4)} m\u00b2`;
}
