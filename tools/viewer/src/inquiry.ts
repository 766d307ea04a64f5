// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tools: what a click asks, and how the answer is written and drawn.
import type { MapPosition } from 'ptin-decoder';
import type { Sight, Station } from './answers';
import { drawnSight } from './drawn_sight';
import { bound, coordinates, height as heightText, interval, length as lengthText, metres, number, signOf } from './format';
import type { Frame } from './frame';
import type { Answer, Certainty, FromWorker, Question, ToWorker } from './messages';
import { colour, download, hide, part, speak, toast } from './page';
import { csvOf, drawPlot } from './plot';
import type { Place, Relief } from './relief';
import { climbOf, extentOf, heightAlong, heightsOf, runsOf } from './stations';

export type Tool = 'height' | 'profile' | 'sight' | 'viewshed';
type AnswerOf<K extends Answer['kind']> = Extract<Answer, { kind: K }>;
type AlongLine = AnswerOf<'profile'> | AnswerOf<'sight'>;

export class Inquiry {
  private tool: Tool = 'height';
  private from: MapPosition | null = null;
  private asked: Question | null = null;
  private ticket = 0;
  private shownProfile: AlongLine | null = null;

  constructor(
    private readonly relief: Relief, private readonly frame: () => Frame | null, private readonly send: (m: ToWorker) => void,
  ) {
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
    this.close();
    this.tool = tool;
    document.querySelector<HTMLInputElement>(`input[name=tool][value=${tool}]`)!.checked = true;
    const hints: Record<Tool, string> = {
      height: 'Click the terrain for its height', profile: 'Click where the profile begins, then where it ends',
      sight: 'Click the eye, then the target', viewshed: 'Click where the observer stands',
    };
    if (tool === 'height' || tool === 'profile') toast(hints[tool]);
    else this.showForm(tool, hints[tool]);
  }

  /** What a line of sight or a viewshed is asked with, before there is an answer. */
  private showForm(tool: 'sight' | 'viewshed', hint: string): void {
    this.write(tool === 'sight' ? 'Line of sight' : 'Viewshed', '', hint);
    this.layOut(tool, false);
  }

  /** Shows the parts of the answer that a tool has. */
  private layOut(tool: Tool, hasProfile: boolean): void {
    hide(false, 'answer');
    hide(tool !== 'sight' && tool !== 'viewshed', 'sight-form');
    hide(tool !== 'viewshed', 'radius-field');
    hide(tool === 'viewshed', 'frequency-field');
    hide(!hasProfile, 'csv', 'plot');
  }

  /** Forgets what was asked, with its marks. */
  close(): void {
    this.from = null;
    this.asked = null;
    this.shownProfile = null;
    ++this.ticket;
    hide(true, 'answer');
    this.relief.clearMarks();
    this.relief.setDrape(null, []);
  }

  /** A click on the terrain. */
  click(place: Place | null): void {
    const frame = this.frame();
    if (frame === null) return;
    if (place === null) {
      toast('There is no terrain at that place');
      return;
    }
    const at = { x: frame.mapX(place.x), y: frame.mapY(place.y) };
    if (this.tool === 'height') {
      this.ask({ kind: 'height', at });
    } else if (this.tool === 'viewshed') {
      this.ask(this.viewshedAt(at));
    } else if (this.from === null) {
      const { tool } = this;
      this.close();
      this.from = at;
      this.relief.addMark(place, colour('mark'));
      if (tool === 'sight') this.showForm(tool, 'Now click the target');
      else toast('Now click where it ends');
    } else {
      this.ask(this.lineTo(this.from, at));
      this.from = null;
    }
  }

  /** An answer of the Worker, or its refusal. Those to earlier questions are left alone. */
  take(message: Extract<FromWorker, { kind: 'answer' | 'refused' }>): void {
    if (message.ticket !== this.ticket) return;
    if (message.kind === 'refused') {
      toast(message.message);
      return;
    }
    const frame = this.frame();
    if (frame !== null) void this.show(message.answer, frame);
  }

  private ask(question: Question): void {
    this.asked = question;
    this.send({ kind: 'ask', ticket: ++this.ticket, question });
  }

  private lineTo(from: MapPosition, to: MapPosition): Question {
    if (this.tool === 'profile') return { kind: 'profile', from, to };
    const value = this.formValue;
    return {
      kind: 'sight', from, to,
      request: { observerHeight: value('observer'), targetHeight: value('target'), frequency: value('frequency') * 1e9 },
    };
  }

  private viewshedAt(at: MapPosition): Question {
    const value = this.formValue;
    return {
      kind: 'viewshed', at, observerHeight: value('observer'), targetHeight: value('target'), radius: value('radius') * 1000,
    };
  }

  private readonly formValue = (name: string): number => {
    const field = part<HTMLFormElement>('sight-form').elements.namedItem(name) as HTMLInputElement;
    return Math.max(0, Number(field.value) || 0);
  };

  /** The same places with what the form says now. */
  private askAgain(): void {
    if (this.asked?.kind === 'sight') this.ask(this.lineTo(this.asked.from, this.asked.to));
    if (this.asked?.kind === 'viewshed') this.ask(this.viewshedAt(this.asked.at));
  }

  private async show(answer: Answer, frame: Frame): Promise<void> {
    this.relief.clearMarks();
    this.shownProfile = answer.kind === 'profile' || answer.kind === 'sight' ? answer : null;
    this.layOut(answer.kind, this.shownProfile !== null);
    if (answer.kind === 'height') this.showHeight(answer, frame);
    if (answer.kind === 'profile') this.showProfile(answer, frame);
    if (answer.kind === 'sight') this.showSight(answer, frame);
    if (answer.kind === 'viewshed') await this.showViewshed(answer, frame);
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
    const where = coordinates(at.x, at.y, frame.isDegrees);
    const { height, least, most } = located;
    this.tell({ x: at.x, y: at.y, height, least, most, error: certainty.error, deviation: certainty.deviation });
    if (located.state !== 'surface' || height === null) {
      this.write('Height', located.state === 'void' ? 'No data here' : 'Outside of the terrain', where);
    } else {
      const isExact = certainty.isExact || least === null || most === null || least === most;
      const [low, high] = isExact ? ['', ''] : interval(least, most, sign);
      const told = isExact ? exactly(certainty) : `certainly between ${low} and ${high}`;
      const cost = answer.cost ? `\n${answer.cost}` : '';
      this.write('Height', heightText(height, isExact ? 0 : (most - least) / 2, sign), `${told}\n${where}${cost}`);
      this.relief.addMark(this.placeOf(frame, at, height), colour('mark'));
    }
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
      `from ${heightText(low, d, sign)} to ${heightText(high, d, sign)}, up ${number(climb.up, 3)} ${sign}, ` +
      `down ${number(climb.down, 3)} ${sign}\n${certaintyNote(certainty, sign)}`);
    this.drawGround(answer, frame, colour('mark'));
    this.plot(answer);
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
    const { viewshed, at } = answer;
    this.relief.setDrape(await createImageBitmap(viewshed.picture), viewshed.window);
    this.write('Viewshed', 'Green is seen', `${metres(answer.radius)} around ${coordinates(at.x, at.y, frame.isDegrees)}`, 'good');
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
