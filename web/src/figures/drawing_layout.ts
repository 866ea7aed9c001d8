// What stands where in the drawing of an assembly: shapes in the units of the view box, which drawing.tsx writes as SVG.
import type { Assembly, Joint, Segment } from '../views';
import { general, withPower } from '../text';
import { thinSpace } from './theme';

// The width of the view box is fixed, its height follows.
export const viewWidth = 900;
const margin = 24;
const tallest = 250; // the thickest part at most
const font = 15; // as in page.css
const character = 0.58 * font; // of a text's mean width, wide enough for any system font
const labelGap = 10;
const jointGap = 64; // between tool and holder, for the springs: not to scale
const wallWidth = 22;
const boxWidth = 120; // of a measured holder

export type Point = [x: number, y: number];
export interface Box {
  shape: 'box';
  kind: string; // a class of page.css
  x: number;
  y: number;
  width: number;
  height: number;
}
export interface Line {
  shape: 'line';
  kind: string;
  from: Point;
  to: Point;
}
export interface Path {
  shape: 'path';
  kind: string;
  points: Point[];
}
export interface Dot {
  shape: 'dot';
  at: Point;
}
export interface Label {
  shape: 'label';
  at: Point;
  text: string;
  anchor: 'middle' | 'start';
}
export type Shape = Box | Line | Path | Dot | Label;

/** A piece as it is drawn: from x, along the axis. */
interface Piece {
  part: Segment['part'];
  x: number;
  width: number;
  height: number; // about the axis
  bore: number;
  fluted: boolean;
  length: string;
  diameter: string;
}

interface Arrangement {
  scale: number; // units a millimetre
  pieces: Piece[];
  toolX: number; // the tip
  jointX: number; // the tool's end
  holderX: number; // the holder's mouth
  endX: number; // the end of the last piece, where a wall begins
  highest: number; // of all pieces and symbols
}

function box(kind: string, x: number, y: number, width: number, height: number): Box {
  return { shape: 'box', kind, x, y, width, height };
}

function line(kind: string, from: Point, to: Point): Line {
  return { shape: 'line', kind, from, to };
}

function label(x: number, y: number, text: string, anchor: Label['anchor'] = 'middle'): Label {
  return { shape: 'label', at: [x, y], text, anchor };
}

function clamp(value: number, low: number, high: number): number {
  return Math.max(low, Math.min(value, high));
}

function textWidth(text: string): number {
  return character * [...text].length;
}

function millimetres(length: number): string {
  return general(length, 6);
}

function total(segments: Segment[]): number {
  return segments.reduce((sum, { length_mm }) => sum + length_mm, 0);
}

function thickest(segments: Segment[]): number {
  return Math.max(0, ...segments.map(({ diameter_mm }) => diameter_mm));
}

/** The joint if it acts at several points along the shank. */
function distributed({ joint }: Assembly): Joint | null {
  return joint !== null && joint.points > 1 ? joint : null;
}

/** The joint if it acts at one point, where the drawing leaves a gap for its symbol. */
function atOnePoint({ joint }: Assembly): Joint | null {
  return joint !== null && joint.points <= 1 ? joint : null;
}

/** Pieces one after the other from x. */
function row(segments: Segment[], from: number, scale: number): Piece[] {
  let end = from;
  return segments.map(({ part, length_mm, diameter_mm, inner_diameter_mm: bore, flutes = 0 }) => {
    const x = end;
    end += scale * length_mm;
    return {
      part,
      x,
      width: scale * length_mm,
      height: scale * diameter_mm,
      bore: scale * bore,
      fluted: flutes > 0,
      length: millimetres(length_mm),
      diameter: `⌀${thinSpace}${millimetres(diameter_mm)}${bore > 0 ? `/${millimetres(bore)}` : ''}`,
    };
  });
}

function arrange(assembly: Assembly): Arrangement {
  const { tool, holder } = assembly;
  const measured = holder.kind === 'measured';
  const gap = atOnePoint(assembly) !== null;
  const shank = distributed(assembly)?.shank ?? [];
  const length = total(tool) + Math.max(total(holder.segments), total(shank));
  const room = viewWidth - 2 * margin - (gap ? jointGap : 0) - (measured ? boxWidth : wallWidth);
  const thick = thickest([...tool, ...holder.segments, ...shank]);
  const scale = Math.min(room / length, tallest / thick);
  const toolX = margin + 0.5 * (room - scale * length);
  const jointX = toolX + scale * total(tool);
  const holderX = jointX + (gap ? jointGap : 0);
  return {
    scale,
    pieces: [...row(tool, toolX, scale), ...row(holder.segments, holderX, scale), ...row(shank, holderX, scale)],
    toolX,
    jointX,
    holderX,
    endX: holderX + scale * Math.max(total(holder.segments), total(shank)),
    highest: Math.max(scale * thick, gap || measured ? 110 : 0),
  };
}

function pieceShapes({ part, x, width, height, bore, fluted }: Piece, axis: number): Shape[] {
  const top = axis - 0.5 * height;
  const out: Shape[] = [box(part === 'shank' ? 'tool shank' : part, x, top, width, height)];
  if (fluted) out.push(box('flutes', x, top, width, height));
  if (bore > 0) for (const y of [axis - 0.5 * bore, axis + 0.5 * bore]) out.push(line('bore', [x, y], [x + width, y]));
  return out;
}

/** A zigzag of a spring along the vertical from y1 to y2. */
function zigzag(x: number, y1: number, y2: number, halfWidth: number, turns: number): Path {
  const step = (y2 - y1) / (2 * turns);
  const peaks = Array.from({ length: 2 * turns }, (_, i): Point => [x + (i % 2 === 0 ? halfWidth : -halfWidth), y1 + (i + 0.5) * step]);
  return { shape: 'path', kind: 'spring', points: [[x, y1], ...peaks, [x, y2]] };
}

/** The joint at one point: above the axis the spring between the shifts, below it the one between the rotations. */
function jointShapes({ jointX: left, holderX: right }: Arrangement, axis: number): Shape[] {
  const middle = 0.5 * (left + right);
  const centre = axis + 28;
  // Two turns from the centre, which turns with the tool, to the holder.
  const spiral = Array.from({ length: 41 }, (_, i): Point => {
    const turn = i / 40;
    const angle = 4 * Math.PI * turn;
    return [middle + 17 * turn * Math.cos(angle), centre + 17 * turn * Math.sin(angle)];
  });
  return [
    line('plate', [left, axis - 50], [left, axis + 50]),
    line('plate', [right, axis - 50], [right, axis + 50]),
    line('spring', [left, axis - 46], [middle, axis - 46]),
    zigzag(middle, axis - 46, axis - 8, 8, 4),
    line('spring', [middle, axis - 8], [right, axis - 8]),
    { shape: 'path', kind: 'spring', points: spiral },
    line('spring', [left, centre], [middle, centre]),
    line('spring', [middle + 17, centre], [right, centre]),
  ];
}

/** The points of a distributed joint, evenly from the deep end to the mouth, on both sides of the shank. */
function pointShapes({ pieces, scale, holderX }: Arrangement, { points, insertion_length_mm }: Joint, axis: number): Shape[] {
  const length = scale * (insertion_length_mm ?? 0);
  return Array.from({ length: points }, (_, i) => holderX + (length * i) / (points - 1)).flatMap((x) => {
    const here = pieces.filter((piece) => piece.part === 'shank' && x >= piece.x - 0.05 && x <= piece.x + piece.width + 0.05);
    const half = Math.max(0, ...here.map(({ height }) => 0.5 * height));
    return [-1, 1].flatMap((side): Shape[] => [
      zigzag(x, axis + side * half, axis + side * (half + 14), 3, 2),
      { shape: 'dot', at: [x, axis + side * half] },
    ]);
  });
}

/** What stands behind the last piece; a shank stands in it where it is not built of segments. */
function baseShapes({ holderX, endX, highest }: Arrangement, { holder }: Assembly, axis: number): Shape[] {
  const half = 0.5 * highest + 8;
  if (holder.kind === 'free') return [];
  if (holder.kind === 'measured') {
    return [
      box('measured', holderX, axis - half, endX - holderX + boxWidth, 2 * half),
      label(endX + 0.5 * boxWidth, axis - 3, 'measured'),
      label(endX + 0.5 * boxWidth, axis + 15, 'holder'),
    ];
  }
  const mouth = holder.kind === 'wall' ? holderX : endX;
  return [
    box('wall', mouth, axis - half, endX - mouth + wallWidth, 2 * half),
    line('plate', [mouth, axis - half], [mouth, axis + half]),
  ];
}

/**
 * Where labels of these widths stand side by side in their order, none over another: each as near to its target as the
 * others allow (least squares), within [low, high] where all fit. Returns their centres, as many as targets.
 */
export function sideBySide(targets: number[], widths: number[], low: number, high: number): number[] {
  // Measured from where each would stand if all were packed to the left, the centres only must not decrease: isotonic
  // regression, by pooling neighbours that do, then held within what is left of the room.
  const packed: number[] = [];
  const pools: { sum: number; count: number }[] = [];
  let edge = low;
  targets.forEach((target, i) => {
    const width = widths[i]!;
    packed.push(edge + 0.5 * width);
    edge += width;
    let pool = { sum: target - packed[i]!, count: 1 };
    for (let before = pools.pop(); before !== undefined; before = pools.pop()) {
      if (before.sum * pool.count <= pool.sum * before.count) {
        pools.push(before);
        break;
      }
      pool = { sum: before.sum + pool.sum, count: before.count + pool.count };
    }
    pools.push(pool);
  });
  const shifts = pools.flatMap(({ sum, count }) => Array<number>(count).fill(clamp(sum / count, 0, Math.max(0, high - edge))));
  return packed.map((centre, i) => centre + shifts[i]!);
}

interface Mark {
  place: number; // what it belongs to
  text: string | null; // null: keeps room for a line to a label further on
  fromY: number; // where its place ends, towards the label
}

/**
 * Labels side by side. Each is tied to its place by a line, straight until all pieces are passed (clearY), then aslant:
 * in the order of their places no line crosses another. Returns the centres as well.
 */
function labelShapes(marks: Mark[], y: number, clearY: number): { shapes: Shape[]; centres: number[] } {
  const widths = marks.map(({ text }) => textWidth(text ?? '') + labelGap);
  const centres = sideBySide(marks.map(({ place }) => place), widths, 0, viewWidth);
  const near = y > clearY ? y - font : y + 5;
  const shapes = marks.flatMap(({ place, text, fromY }, i) => {
    const out: Shape[] = [];
    const centre = centres[i]!;
    if (text === null || Math.abs(centre - place) > 0.5 || Math.abs(clearY - fromY) > 1) {
      const end = text === null ? y - font - 2 : near;
      out.push({ shape: 'path', kind: 'leader', points: [[place, fromY], [place, clearY], [centre, near], [centre, end]] });
    }
    if (text !== null) out.push(label(centre, y, text));
    return out;
  });
  return { shapes, centres };
}

function fit(marks: Mark[]): boolean {
  return marks.reduce((sum, { text }) => sum + textWidth(text ?? '') + labelGap, 0) <= viewWidth;
}

function sorted(marks: Mark[]): Mark[] {
  return [...marks].sort((a, b) => a.place - b.place);
}

function dimension(from: number, to: number, y: number): Shape[] {
  const ends = [from, to].map((x) => line('dimension', [x, y - 4], [x, y + 4]));
  return [line('dimension', [from, y], [to, y]), ...ends];
}

/** A dimension line below every piece, the shank's below the holder's. `next`: where the next row may begin. */
function lengthShapes({ pieces }: Arrangement, y: number): { shapes: Shape[]; next: number } {
  const height = ({ part }: Piece) => (part === 'shank' ? y + 10 : y);
  const lines = pieces.flatMap((piece) => dimension(piece.x, piece.x + piece.width, height(piece)));
  const marks = pieces.map((piece): Mark => ({ place: piece.x + 0.5 * piece.width, text: piece.length, fromY: height(piece) }));
  const clear = pieces.some(({ part }) => part === 'shank') ? y + 14 : y;
  if (!fit(marks)) return { shapes: lines, next: clear + 10 };
  return { shapes: [...lines, ...labelShapes(sorted(marks), clear + 32, clear).shapes], next: clear + 50 };
}

/** Tool and holder as wholes. */
function wholeShapes({ scale, toolX, holderX }: Arrangement, { tool, holder }: Assembly, y: number): Shape[] {
  const wholes = [
    { name: 'tool', length: total(tool), from: toolX },
    { name: 'holder', length: total(holder.segments), from: holderX },
  ].filter(({ length }) => length > 0);
  const marks = wholes.map(
    ({ name, length, from }): Mark => ({ place: from + 0.5 * scale * length, text: `${name} ${millimetres(length)} mm`, fromY: y }),
  );
  return [...wholes.flatMap(({ length, from }) => dimension(from, from + scale * length, y)), ...labelShapes(marks, y + 24, y).shapes];
}

/** A bar of 1, 2 or 5 times a power of ten, about a seventh of the picture at most. */
function scaleShapes({ scale }: Arrangement, y: number): Shape[] {
  const most = (0.15 * viewWidth) / scale;
  const decade = 10 ** Math.floor(Math.log10(most));
  const bar = [5 * decade, 2 * decade].find((length) => length <= most) ?? decade;
  return [box('scale', margin, y - 5, bar * scale, 5), label(margin + bar * scale + 8, y, `${millimetres(bar)} mm`, 'start')];
}

/** What the symbol of the joint says. */
function jointTexts({ joint, holder }: Assembly): string[] {
  if (holder.kind === 'free') return ['free'];
  if (joint === null) return ['rigid joint'];
  const { translational_stiffness_n_per_m: shift, rotational_stiffness_n_m_per_rad: rotation } = joint;
  return [
    `Shift: k ${withPower(shift)} N/m, c ${withPower(joint.translational_damping_n_s_per_m)} N·s/m`,
    `Rotation: k ${withPower(rotation)} N·m/rad, c ${withPower(joint.rotational_damping_n_m_s_per_rad)} N·m·s/rad`,
  ];
}

/** The joint's texts on top, the diameters below them. */
function diameterShapes({ pieces, jointX, holderX }: Arrangement, assembly: Assembly, top: number, axis: number, clearY: number): Shape[] {
  const texts = jointTexts(assembly);
  const marks = pieces.map(({ x, width, height, diameter }): Mark => ({ place: x + 0.5 * width, text: diameter, fromY: axis - 0.5 * height }));
  const end = pieces.filter(({ part }) => part === 'tool').pop(); // the piece that meets the joint
  const joint: Mark = { place: 0.5 * (jointX + holderX), text: null, fromY: axis - (atOnePoint(assembly) ? 50 : 0.5 * (end?.height ?? 0)) };
  const all = sorted(fit(marks) ? [...marks, joint] : [joint]);
  const { shapes, centres } = labelShapes(all, top + 20 * texts.length + 18, clearY);
  const half = 0.5 * Math.max(...texts.map(textWidth));
  const centre = clamp(centres[all.indexOf(joint)]!, half, viewWidth - half);
  return [...shapes, ...texts.map((text, i) => label(centre, top + 16 + 20 * i, text))];
}

function inSegments(segments: Segment[]): string {
  return `of ${millimetres(total(segments))} mm in ${segments.length} segment${segments.length === 1 ? '' : 's'}`;
}

/** The drawing in words, for who cannot see it. */
function inWords(assembly: Assembly): string {
  const { tool, joint, holder } = assembly;
  if (holder.kind === 'free') return `Tool ${inSegments(tool)}, held by nothing`;
  const points = distributed(assembly)?.points;
  const joined =
    joint === null ? 'joined rigidly to' : points === undefined ? 'on an elastic joint to' : `in an elastic joint of ${points} points on`;
  const held = {
    measured: 'a measured holder',
    wall: 'a rigid wall',
    segments: `a holder ${inSegments(holder.segments)} on a rigid wall`,
  }[holder.kind];
  return `Tool ${inSegments(tool)}, ${joined} ${held}`;
}

export interface Drawing {
  height: number; // of the view box
  words: string;
  shapes: Shape[]; // from behind to the front
}

export function layOut(assembly: Assembly): Drawing {
  const arrangement = arrange(assembly);
  const { pieces, toolX, endX, highest } = arrangement;
  const top = 4;
  const clear = top + 20 * jointTexts(assembly).length + 44;
  const axis = clear + 10 + 0.5 * highest;
  const along = distributed(assembly);
  const lengths = lengthShapes(arrangement, axis + 0.5 * highest + 26);
  return {
    height: lengths.next + 72,
    words: inWords(assembly),
    shapes: [
      ...baseShapes(arrangement, assembly, axis),
      ...pieces.flatMap((piece) => pieceShapes(piece, axis)),
      ...(atOnePoint(assembly) ? jointShapes(arrangement, axis) : []),
      ...(along ? pointShapes(arrangement, along, axis) : []),
      line('axis', [toolX - 12, axis], [endX + 6, axis]),
      ...diameterShapes(arrangement, assembly, top, axis, clear),
      ...lengths.shapes,
      ...wholeShapes(arrangement, assembly, lengths.next),
      ...scaleShapes(arrangement, lengths.next + 60),
    ],
  };
}
