// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the relief is drawn. z is scaled here, so exaggeration costs nothing; slopes and heights are always those of the terrain
// itself. Light is computed a vertex, since a processor may have to draw.

/** Uniforms that all programs of places of the scene have. */
const seenFrom = /* glsl */ `
uniform mat4 matrix;
uniform vec3 eye;
uniform float exaggeration;
vec3 raised(vec3 place) { return vec3(place.xy, place.z * exaggeration); }
`;

/** The air between the eye and a place: none up to a distance, then more and more. */
const air = /* glsl */ `
uniform float hazeDistance;
float airAt(vec3 place) {
  return 0.8 * (1.0 - exp(-max(length(place - eye) - hazeDistance, 0.0) / (2.4 * hazeDistance)));
}
`;

/**
 * Ground and water. The key light comes from the upper left of the picture, as on maps, a weaker one from the other side; the sky
 * lights hollows less (normal.w, -1 to 1: below or above what is around).
 */
export const groundVertex = /* glsl */ `
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
uniform vec3 key;
uniform vec3 fill;
uniform float isFlat;
uniform vec2 rampRange;
out vec3 vPlace;
out vec3 vLight;
out vec2 vShare;  // of the ramp, and of the air
${seenFrom}${air}
void main() {
  vPlace = position;
  vec3 place = raised(position);
  vec3 up = isFlat > 0.0 ? vec3(0.0, 0.0, 1.0) : normalize(vec3(normal.xy * exaggeration, normal.z));
  float direct = max(dot(up, key), 0.0), second = max(dot(up, fill), 0.0);
  float open = isFlat > 0.0 ? 0.0 : normal.w;
  vec3 sky = vec3(0.33, 0.36, 0.41) * (0.62 + 0.38 * up.z) * (1.0 + 0.55 * open);
  vLight = sky + vec3(0.80, 0.765, 0.70) * direct * (1.0 + 0.16 * open) + vec3(0.10, 0.115, 0.15) * second;
  vShare = vec2((position.z - rampRange.x) / max(rampRange.y - rampRange.x, 1e-6), airAt(place));
  gl_Position = matrix * vec4(place, 1.0);
}`;

/**
 * `details`: slopes, isolines and what lies over the terrain, each of which is of a pixel. `map`: text
 * with a function `mapped`, which lays a base map over the colour of a place (map_shader).
 */
export const groundFragment = (details: boolean, map = ''): string => /* glsl */ `
uniform sampler2D ramp;
uniform vec3 haze;
uniform vec4 paint;           // instead of the ramp where its last is not 0; 2: hatched
uniform float hatch;          // pixels
in vec3 vPlace;
in vec3 vLight;
in vec2 vShare;
out vec4 drawn;
${details ? detailText : ''}${map}
void main() {
  vec3 tint = paint.rgb;
  if (paint.a == 0.0) tint = ${details ? 'detailTint()' : 'texture(ramp, vec2(clamp(vShare.x, 0.002, 0.998), 0.5)).rgb'};
  if (paint.a == 2.0 && mod(gl_FragCoord.x + gl_FragCoord.y, 9.0 * hatch) < 1.4 * hatch) tint *= 0.86;
  vec3 colour = tint * ${details ? 'detailLight()' : 'vLight'};
  ${map !== '' ? 'if (paint.a != 2.0) colour = mapped(colour);' : ''}
  ${details ? 'colour = overlaid(colour);' : ''}
  drawn = vec4(mix(colour, haze, vShare.y), 1.0);
}`;

const detailText = /* glsl */ `
uniform float shading;        // 0 heights, 1 slope, 2 hillshade
uniform sampler2D slopeRamp;
uniform float interval;       // of isolines in scene z; 0: none
uniform float intervalPhase;  // of z = 0, in intervals, modulo 5
uniform sampler2D drape;
uniform vec4 drapeWindow;     // scene x, y, width, height; width 0: none
const vec3 isolineColour = vec3(0.16, 0.1, 0.06);

vec3 detailTint() {
  // Slopes in full light have 1.3 times the light of a plain, and are not to be white.
  if (shading == 2.0) return vec3(0.76, 0.76, 0.75);
  if (shading == 1.0) {
    vec3 flatNormal = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
    float degrees = acos(clamp(abs(flatNormal.z), 0.0, 1.0)) * 57.29578;
    return texture(slopeRamp, vec2(clamp(degrees / 60.0, 0.002, 0.998), 0.5)).rgb;
  }
  return texture(ramp, vec2(clamp(vShare.x, 0.002, 0.998), 0.5)).rgb;
}

vec3 detailLight() { return shading == 1.0 ? mix(vec3(1.0), vLight, 0.35) : vLight; }

float isolines() {
  float lines = vPlace.z / interval + intervalPhase;
  float width = fwidth(lines);
  if (width < 1e-5) return 0.0;  // a plain at a level, as the sea is
  float off = abs(fract(lines - 0.5) - 0.5) / width;
  bool isFifth = mod(floor(lines + 0.5), 5.0) == 0.0;
  float half_width = isFifth ? 1.1 : 0.65;
  float line = 1.0 - smoothstep(half_width - 0.5, half_width + 0.5, off);
  float crowded = smoothstep(0.25, 0.6, width * (isFifth ? 0.35 : 1.0));
  return line * (isFifth ? 0.85 : 0.5) * (1.0 - crowded);
}

vec3 overlaid(vec3 colour) {
  if (interval > 0.0) colour = mix(colour, isolineColour, isolines());
  if (drapeWindow.z <= 0.0) return colour;
  vec2 at = (vPlace.xy - drapeWindow.xy) / drapeWindow.zw;
  if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(1.0)))) return colour;
  vec4 over = texture(drape, at);
  return mix(colour, over.rgb, over.a * 0.62);
}
`;

/** The plinth: walls from the border down to a plane. */
export const wallVertex = /* glsl */ `
layout(location = 0) in vec4 position;  // the last: 1 at the foot
layout(location = 1) in vec2 outwards;
uniform vec3 key;
uniform float foot;                     // scene z, exaggerated
out vec3 vPlace;
out float vLight;
out float vAir;
${seenFrom}${air}
void main() {
  vec3 place = raised(position.xyz);
  if (position.w > 0.0) place.z = foot;
  vPlace = place;
  vLight = 0.86 + 0.2 * dot(vec3(outwards, 0.0), key);
  vAir = airAt(place);
  gl_Position = matrix * vec4(place, 1.0);
}`;

export const wallFragment = /* glsl */ `
uniform vec3 haze;
uniform vec3 stone;
in vec3 vPlace;
in float vLight;
in float vAir;
out vec4 drawn;
void main() { drawn = vec4(mix(stone * vLight, haze, vAir), 1.0); }`;

/** The sky, where nothing else is: one triangle over the picture. */
export const skyVertex = /* glsl */ `
layout(location = 0) in vec2 position;
uniform vec3 ahead, across, upwards;  // the ray of a point of the picture is ahead + x across + y upwards
out vec3 vRay;
void main() {
  vRay = ahead + position.x * across + position.y * upwards;
  gl_Position = vec4(position, 1.0, 1.0);
}`;

export const skyFragment = /* glsl */ `
uniform vec3 haze, zenith, below;
in vec3 vRay;
out vec4 drawn;
void main() {
  float rise = vRay.z / length(vRay);
  drawn = vec4(rise > 0.0 ? mix(haze, zenith, 1.0 - exp(-7.0 * rise)) : mix(haze, below, 1.0 - exp(2.4 * rise)), 1.0);
}`;

/** A place, moved towards the eye by a share of the way. */
const lifted = /* glsl */ `
uniform float lift;
vec4 seen(vec3 place) { return matrix * vec4(mix(raised(place), eye, lift), 1.0); }
`;

/** Edges, bodies and marks. */
export const lineVertex = /* glsl */ `
layout(location = 0) in vec3 position;
uniform float size;  // of marks, pixels of the drawing
${seenFrom}${lifted}
void main() {
  gl_PointSize = size;
  gl_Position = seen(position);
}`;

export const lineFragment = /* glsl */ `
uniform vec4 colour;
out vec4 drawn;
void main() { drawn = colour; }`;

/** A line of some pixels' width: each stretch is four corners, which know its other end and on which side of it they are. */
export const ribbonVertex = /* glsl */ `
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 other;
layout(location = 2) in float turn;
uniform float size;    // pixels of the drawing
uniform vec2 picture;  // its size
${seenFrom}${lifted}
void main() {
  vec4 here = seen(position), there = seen(other);
  vec2 way = (there.xy / max(there.w, 1e-6) - here.xy / max(here.w, 1e-6)) * picture;
  vec2 across = length(way) > 1e-6 ? normalize(vec2(-way.y, way.x)) : vec2(0.0);
  here.xy += across * turn * size * here.w / picture;
  gl_Position = here;
}`;

export const markFragment = /* glsl */ `
uniform vec4 colour;
out vec4 drawn;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  if (r > 1.0) discard;
  drawn = vec4(r > 0.62 ? vec3(1.0) : colour.rgb, 1.0 - smoothstep(0.9, 1.0, r));
}`;
