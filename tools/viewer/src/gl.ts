// SPDX-License-Identifier: GPL-3.0-or-later
//
// WebGL 2 as far as the picture needs it: programs, buffers of numbers, textures.

type Uniform = number | readonly number[] | Float32Array | Float64Array;

export class Program {
  private readonly program: WebGLProgram;
  private readonly places = new Map<string, WebGLUniformLocation | null>();

  /** Attributes are at the places that the shader's own `layout` names. Throws with what the driver says. */
  constructor(private readonly gl: WebGL2RenderingContext, vertex: string, fragment: string) {
    this.program = gl.createProgram()!;
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
      const shader = gl.createShader(kind)!;
      gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${text}`);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
      gl.deleteShader(shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const logs = gl.getAttachedShaders(this.program)!.map((shader) => gl.getShaderInfoLog(shader));
      throw new Error([gl.getProgramInfoLog(this.program), ...logs].filter(Boolean).join('; '));
    }
  }

  /** Makes it the one that draws, with these numbers; those of other names stay as they are. */
  use(uniforms: Record<string, Uniform>): void {
    const { gl } = this;
    gl.useProgram(this.program);
    for (const [name, value] of Object.entries(uniforms)) {
      let at = this.places.get(name);
      if (at === undefined) this.places.set(name, at = gl.getUniformLocation(this.program, name));
      if (typeof value === 'number') gl.uniform1f(at, value);
      else if (value.length === 2) gl.uniform2fv(at, value as number[]);
      else if (value.length === 3) gl.uniform3fv(at, value as number[]);
      else if (value.length === 4) gl.uniform4fv(at, value as number[]);
      else gl.uniformMatrix4fv(at, false, value as number[]);
    }
  }

  /** Which texture unit a sampler reads. */
  sampler(name: string, unit: number): void {
    this.gl.useProgram(this.program);
    this.gl.uniform1i(this.gl.getUniformLocation(this.program, name), unit);
  }
}

export interface Attribute {
  at: number;
  numbers: Float32Array | Int16Array;
  /** Numbers a vertex. */
  size: number;
}

/** Vertices on the card, and what joins them. */
export class Vertices {
  private readonly array: WebGLVertexArrayObject;
  private readonly buffers: WebGLBuffer[] = [];
  readonly count: number;

  constructor(private readonly gl: WebGL2RenderingContext, attributes: readonly Attribute[], corners: Uint32Array | null) {
    this.array = gl.createVertexArray()!;
    gl.bindVertexArray(this.array);
    for (const { at, numbers, size } of attributes) {
      this.fill(gl.ARRAY_BUFFER, numbers);
      gl.enableVertexAttribArray(at);
      const isShort = numbers instanceof Int16Array;
      gl.vertexAttribPointer(at, size, isShort ? gl.SHORT : gl.FLOAT, isShort, 0, 0);
    }
    if (corners !== null) this.fill(gl.ELEMENT_ARRAY_BUFFER, corners);
    this.count = corners?.length ?? attributes[0].numbers.length / attributes[0].size;
    this.isIndexed = corners !== null;
    gl.bindVertexArray(null);
  }
  private readonly isIndexed: boolean;

  private fill(target: number, numbers: ArrayBufferView): void {
    const buffer = this.gl.createBuffer()!;
    this.buffers.push(buffer);
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, numbers, this.gl.STATIC_DRAW);
  }

  /** `mode`: of gl. */
  draw(mode: number, first = 0, count = this.count - first): void {
    if (count <= 0) return;
    this.gl.bindVertexArray(this.array);
    if (this.isIndexed) this.gl.drawElements(mode, count, this.gl.UNSIGNED_INT, 4 * first);
    else this.gl.drawArrays(mode, first, count);
  }

  free(): void {
    this.gl.deleteVertexArray(this.array);
    for (const buffer of this.buffers) this.gl.deleteBuffer(buffer);
  }
}

/**
 * Draws with smooth edges: four samples a pixel, apart from the canvas, whose own could not be left away while a slow card has to
 * hurry.
 */
export class Smooth {
  private target: WebGLFramebuffer | null = null;
  private readonly colour: WebGLRenderbuffer | null;
  private readonly depth: WebGLRenderbuffer | null;
  private readonly samples: number;
  private size: readonly [number, number] = [0, 0];

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.samples = Math.min(4, gl.getParameter(gl.MAX_SAMPLES) as number);
    this.colour = gl.createRenderbuffer();
    this.depth = gl.createRenderbuffer();
  }

  /** Begins a drawing, which is smooth until `end`. */
  begin(width: number, height: number): void {
    const { gl, size, samples } = this;
    if (samples < 2) return;
    this.target ??= gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    if (size[0] === width && size[1] === height) return;
    this.size = [width, height];
    for (const [buffer, format, place] of [
      [this.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [this.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
    ] as const) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
    }
  }

  /** Shows what was drawn since `begin`. */
  end(): void {
    const { gl, target, size: [width, height] } = this;
    if (this.samples < 2) return;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }
}

/** Texture units: colours of heights and of slopes, what is laid over the terrain. A base map has the next two (tile_textures). */
export const rampUnit = 0, slopeUnit = 1, drapeUnit = 2;

/** A picture as a texture, bound to its unit. Neither is repeated nor shrunk by steps. */
export function texture(gl: WebGL2RenderingContext, unit: number, picture: Uint8Array | ImageBitmap): WebGLTexture {
  const made = gl.createTexture()!;
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, made);
  for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
  if (picture instanceof Uint8Array) {
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, picture.length / 4, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, picture);
  } else {
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, picture);
  }
  return made;
}
