// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tiles of a base map on the card.
import { treeRow } from './map_tiles';

/** Texture units, beside those of gl. */
const treeUnit = 3, tilesUnit = 4;

/** Pictures of map tiles, one a layer, and the tree that finds them (map_tiles), on units of their own. */
export class TileTextures {
  /** The units of the samplers of map_shader. */
  static readonly samplers = { mapTree: treeUnit, mapTiles: tilesUnit };
  private readonly tree: WebGLTexture;
  private readonly tiles: WebGLTexture;

  /** @param side  Pixels of a tile. */
  constructor(private readonly gl: WebGL2RenderingContext, private readonly side: number, layers: number) {
    this.tree = this.made(treeUnit, gl.TEXTURE_2D, gl.NEAREST);
    this.tiles = this.made(tilesUnit, gl.TEXTURE_2D_ARRAY, gl.LINEAR);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA8, side, side, layers);
  }

  private made(unit: number, target: number, filter: number): WebGLTexture {
    const { gl } = this;
    const made = gl.createTexture()!;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, made);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(target, side, gl.CLAMP_TO_EDGE);
    for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(target, which, filter);
    return made;
  }

  put(layer: number, picture: ImageBitmap): void {
    const { gl, side } = this;
    gl.activeTexture(gl.TEXTURE0 + tilesUnit);
    gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, side, side, 1, gl.RGBA, gl.UNSIGNED_BYTE, picture);
  }

  setTree(tree: Uint16Array): void {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0 + treeUnit);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RG16UI, treeRow, tree.length / 2 / treeRow, 0, gl.RG_INTEGER, gl.UNSIGNED_SHORT, tree);
  }

  free(): void {
    for (const old of [this.tree, this.tiles]) this.gl.deleteTexture(old);
  }
}
