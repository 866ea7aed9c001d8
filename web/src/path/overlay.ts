// What stands over the path: the axes with their scale, and the blocks that are marked.
import type { Matrix4 } from 'three';
import type { PathColours } from './contract';
import { project, roundLength, type Bounds } from './project';

const axisColours = ['x', 'y', 'z'] as const;
const halo = 3;

function label(context: CanvasRenderingContext2D, text: string, x: number, y: number, colours: PathColours): void {
  context.lineWidth = halo;
  context.strokeStyle = colours.panel;
  context.strokeText(text, x, y);
  context.fillStyle = colours.text;
  context.fillText(text, x, y);
}

/** Three axes of a round length at the lowest corner of the box, and that length. */
export function drawAxes(context: CanvasRenderingContext2D, { low, radius }: Bounds, matrix: Matrix4, size: [number, number], colours: PathColours): void {
  const length = roundLength(radius / 2);
  const away = 0.12 * radius; // from the path
  const [x, y, z] = [low.x - away, low.y - away, low.z];
  const corners = Float32Array.from([x, y, z, x + length, y, z, x, y + length, z, x, y, z + length]);
  const at = project(corners, matrix.elements, ...size);
  context.font = '13px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.lineCap = 'round';
  let longest = 0;
  axisColours.forEach((name, k) => {
    const [fromX, fromY, toX, toY] = [at[0]!, at[1]!, at[3 * k + 3]!, at[3 * k + 4]!];
    const pixels = Math.hypot(toX - fromX, toY - fromY);
    longest = Math.max(longest, pixels);
    if (pixels < 8) return; // it points at the eye
    context.beginPath();
    context.moveTo(fromX, fromY);
    context.lineTo(toX, toY);
    context.strokeStyle = colours.text;
    context.lineWidth = 1.5;
    context.stroke();
    label(context, name, toX + (12 * (toX - fromX)) / pixels, toY + (12 * (toY - fromY)) / pixels, colours);
  });
  const lowest = Math.max(...[0, 1, 2, 3].map((k) => at[3 * k + 1]!));
  if (longest > 0) label(context, `each ${Number(length.toPrecision(1))}\u202fmm`, at[0]!, lowest + 16, colours);
}

/** A block's stretch, and a ring at its end where it is the selected one. */
export function drawMark(context: CanvasRenderingContext2D, places: Float32Array, index: number, ring: boolean, colours: PathColours): void {
  const [x, y] = [places[3 * index]!, places[3 * index + 1]!];
  if (Number.isNaN(x + y)) return;
  if (index > 0 && !Number.isNaN(places[3 * index - 3]!)) {
    context.beginPath();
    context.moveTo(places[3 * index - 3]!, places[3 * index - 2]!);
    context.lineTo(x, y);
    context.lineWidth = 5;
    context.strokeStyle = colours.text;
    context.stroke();
  }
  if (!ring) return;
  for (const [style, width] of [[colours.panel, 5], [colours.text, 2]] as const) {
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    context.lineWidth = width;
    context.strokeStyle = style;
    context.stroke();
  }
}
