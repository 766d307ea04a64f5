// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a base map is laid over the terrain: a pixel's place on the map is found by itself, so no triangle bends it.
import { treeRow } from './map_tiles';

export const mapText = /* glsl */ `
uniform mat4 lonOf, latOf;     // by powers of the shares below, radians beside the middle
uniform vec4 mapMiddle;        // column and row of the scene's middle; half the scene's width and depth
uniform vec3 mapTurn;          // tiles a radian; the middle's latitude and its sine
uniform highp usampler2D mapTree;
uniform highp sampler2DArray mapTiles;

// Difference of Mercator's ordinate: atanh(sin a) - atanh(sin b) = atanh((sin a - sin b) / (1 - sin a sin b)), whose first terms 32
// bits hold better than its logarithm where it is small.
float northing(float beside) {
  float off = 2.0 * cos(mapTurn.y + 0.5 * beside) * sin(0.5 * beside);
  float q = off / (1.0 - (mapTurn.z + off) * mapTurn.z), r = q * q;
  return abs(q) < 0.1 ? q * (1.0 + r * (0.33333333 + r * (0.2 + r * 0.14285714))) : 0.5 * log((1.0 + q) / (1.0 - q));
}

vec3 mapped(vec3 colour) {
  vec2 s = vPlace.xy / mapMiddle.zw, q = s * s;
  vec4 across = vec4(1.0, s.x, q.x, q.x * s.x), up = vec4(1.0, s.y, q.y, q.y * s.y);
  vec2 at = mapMiddle.xy + mapTurn.x * vec2(dot(across, lonOf * up), -northing(dot(across, latOf * up)));
  if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(2.0)))) return colour;
  int first = 0, layer = -1;
  vec2 within;
  at *= 0.5;
  for (int depth = 0; depth < 20; depth += 1) {
    at *= 2.0;
    vec2 part = floor(at);
    at -= part;
    int entry = first + int(part.x) + 2 * int(part.y);
    uvec2 node = texelFetch(mapTree, ivec2(entry % ${treeRow}, entry / ${treeRow}), 0).xy;
    if (node.x > 0u) {
      layer = int(node.x) - 1;
      within = at;
    }
    if (node.y == 0u) break;
    first = int(node.y);
  }
  if (layer < 0) return colour;
  vec4 found = textureLod(mapTiles, vec3(within, layer), 0.0);
  // Light without a colour of its own: the map keeps its hues.
  return mix(colour, found.rgb * dot(vLight, vec3(0.3, 0.59, 0.11)), found.a);
}
`;
