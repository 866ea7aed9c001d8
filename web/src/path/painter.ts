// What draws the path, and the one for browsers without WebGL.
import type { OrthographicCamera } from 'three';
import { inAir, type PathColours, type PathData } from './contract';
import { cutting, drawn, isUnstable } from './project';

export interface Painter {
  name: 'webgl' | 'canvas';
  canvas: HTMLCanvasElement;
  resize(width: number, height: number, ratio: number): void;
  load(data: PathData): void; // in the place of what it drew until now; a paint follows
  paint(colours: PathColours): void;
  draw(camera: OrthographicCamera, places: Float32Array): void; // places in pixels, as project gives them
  dispose(): void;
}

/** Blocks of one colour, so that each colour is one stroke. */
export function byColour(blocks: number[], colours: Uint8Array): Map<string, number[]> {
  const out = new Map<string, number[]>();
  for (const i of blocks) {
    const name = `rgb(${colours[3 * i]}, ${colours[3 * i + 1]}, ${colours[3 * i + 2]})`;
    const list = out.get(name);
    if (list) list.push(i);
    else out.set(name, [i]);
  }
  return out;
}

export function canvasPainter(data: PathData): Painter {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d')!;
  const blocksOf = (of: PathData) => ({ air: drawn(of, (kind) => kind === inAir), cuts: drawn(of, cutting), unstable: drawn(of, isUnstable) });
  let blocks = blocksOf(data);
  let colours: PathColours | null = null;
  let groups = new Map<string, number[]>();
  let ratio = 1;
  const stroke = (some: number[], places: Float32Array, style: string, width: number) => {
    context.beginPath();
    for (const i of some) {
      context.moveTo(places[3 * i - 3]!, places[3 * i - 2]!);
      context.lineTo(places[3 * i]!, places[3 * i + 1]!);
    }
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
  };
  return {
    name: 'canvas',
    canvas,
    resize: (width, height, pixels) => {
      ratio = pixels;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    },
    load: (given) => {
      blocks = blocksOf(given);
    },
    paint: (given) => {
      colours = given;
      groups = byColour(blocks.cuts, given.blocks);
    },
    draw: (_camera, places) => {
      if (colours === null) return;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, canvas.width, canvas.height);
      context.lineCap = 'round';
      stroke(blocks.air, places, colours.air, 0.7);
      stroke(blocks.unstable, places, colours.unstable, 8);
      for (const [colour, some] of groups) stroke(some, places, colour, 3);
    },
    dispose: () => {},
  };
}
