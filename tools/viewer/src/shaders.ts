// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the relief is drawn. The scene's matrix scales z, so exaggeration costs nothing; slopes and heights are always those of the
// terrain itself.

export const reliefVertex = /* glsl */ `
varying vec3 vPlace;
varying vec3 vNormal;
varying float vDistance;
void main() {
  vPlace = position;
  vNormal = normal;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  vDistance = length(seen.xyz);
  gl_Position = projectionMatrix * seen;
}`;

export const reliefFragment = /* glsl */ `
uniform float exaggeration;
uniform int shading;          // 0 heights, 1 slope, 2 hillshade
uniform sampler2D ramp;
uniform sampler2D slopeRamp;
uniform vec2 rampRange;       // scene z at both ends
uniform vec3 sun;             // towards it
uniform vec3 haze;
uniform float hazeDistance;
uniform float interval;       // of isolines in scene z; 0: none
uniform float intervalPhase;  // of z = 0, in intervals, modulo 5
uniform vec3 isolineColour;
uniform sampler2D drape;
uniform vec4 drapeWindow;     // scene x, y, width, height; width 0: none
varying vec3 vPlace;
varying vec3 vNormal;
varying float vDistance;

vec3 tint() {
  if (shading == 2) return vec3(0.86, 0.86, 0.85);
  if (shading == 1) {
    vec3 flatNormal = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
    float degrees = acos(clamp(abs(flatNormal.z), 0.0, 1.0)) * 57.29578;
    return texture2D(slopeRamp, vec2(clamp(degrees / 60.0, 0.002, 0.998), 0.5)).rgb;
  }
  float share = (vPlace.z - rampRange.x) / max(rampRange.y - rampRange.x, 1e-6);
  return texture2D(ramp, vec2(clamp(share, 0.002, 0.998), 0.5)).rgb;
}

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

void main() {
  vec3 normal = normalize(vec3(vNormal.xy * exaggeration, vNormal.z));
  float direct = max(dot(normal, sun), 0.0);
  float sky = 0.5 + 0.5 * normal.z;
  float light = shading == 1 ? 0.75 + 0.25 * direct : 0.30 * sky + 0.86 * direct;
  vec3 warm = mix(vec3(0.80, 0.87, 1.0), vec3(1.0, 0.975, 0.93), smoothstep(0.0, 0.8, direct));
  vec3 colour = tint() * light * (shading == 1 ? vec3(1.0) : warm);
  if (interval > 0.0) colour = mix(colour, isolineColour, isolines());
  if (drapeWindow.z > 0.0) {
    vec2 at = (vPlace.xy - drapeWindow.xy) / drapeWindow.zw;
    if (all(greaterThanEqual(at, vec2(0.0))) && all(lessThanEqual(at, vec2(1.0)))) {
      vec4 seen = texture2D(drape, at);
      colour = mix(colour, seen.rgb, seen.a * 0.62);
    }
  }
  float far = 1.0 - exp(-max(vDistance - hazeDistance, 0.0) / (2.5 * hazeDistance));
  gl_FragColor = vec4(mix(colour, haze, 0.75 * far), 1.0);
}`;

/** Edges, bodies and marks. */
export const lineVertex = /* glsl */ `
uniform float lift;
uniform float size;  // of marks, pixels of the drawing
void main() {
  gl_PointSize = size;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  seen.xyz *= 1.0 - lift;
  gl_Position = projectionMatrix * seen;
}`;

export const lineFragment = /* glsl */ `
uniform vec3 colour;
uniform float opacity;
void main() { gl_FragColor = vec4(colour, opacity); }`;

/** A line of some pixels' width: each stretch is four corners, which know its other end and on which side of it they are. */
export const ribbonVertex = /* glsl */ `
attribute vec3 other;
attribute float turn;
uniform float lift;
uniform float width;   // pixels, of the drawing
uniform vec2 picture;  // its size
vec4 seen(vec3 p) {
  vec4 at = modelViewMatrix * vec4(p, 1.0);
  at.xyz *= 1.0 - lift;
  return projectionMatrix * at;
}
void main() {
  vec4 here = seen(position), there = seen(other);
  vec2 way = (there.xy / max(there.w, 1e-6) - here.xy / max(here.w, 1e-6)) * picture;
  vec2 across = length(way) > 1e-6 ? normalize(vec2(-way.y, way.x)) : vec2(0.0);
  here.xy += across * turn * width * here.w / picture;
  gl_Position = here;
}`;

export const markFragment = /* glsl */ `
uniform vec3 colour;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  if (r > 1.0) discard;
  gl_FragColor = vec4(r > 0.62 ? vec3(1.0) : colour, 1.0 - smoothstep(0.9, 1.0, r));
}`;

/** The place itself, for picking: one pixel is read. */
export const placeFragment = /* glsl */ `
varying vec3 vPlace;
void main() { gl_FragColor = vec4(vPlace, 1.0); }`;
