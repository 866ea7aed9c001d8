// Where a plot lies that something is drawn over.
import { useRef, useState } from 'preact/hooks';

/** Where in a drawn figure its depth plot lies, in pixels, and what it spans. */
export interface Frame {
  left: number;
  top: number;
  width: number;
  height: number;
  x: [number, number];
  y: [number, number];
}

interface DrawnAxis {
  _offset: number;
  _length: number;
  range: [number, number];
}

/** What Plotly knows of a figure that it drew; null before. */
export function frameOf(root: HTMLElement): Frame | null {
  const drawn = (root as { _fullLayout?: { xaxis?: DrawnAxis; yaxis?: DrawnAxis } })._fullLayout;
  if (!drawn?.xaxis || !drawn.yaxis) return null;
  const { xaxis, yaxis } = drawn;
  return {
    left: root.offsetLeft + xaxis._offset,
    top: root.offsetTop + yaxis._offset,
    width: xaxis._length,
    height: yaxis._length,
    x: [...xaxis.range],
    y: [...yaxis.range],
  };
}

/** In pixels, kept inside the frame. */
export function toPixels({ left, top, width, height, x, y }: Frame, [speed, depth]: [number, number]): [number, number] {
  const share = (value: number, [low, high]: [number, number]) => Math.min(1, Math.max(0, (value - low) / (high - low)));
  return [left + width * share(speed, x), top + height * (1 - share(depth, y))];
}

export function fromPixels({ left, top, width, height, x, y }: Frame, [across, down]: [number, number]): [number, number] {
  return [x[0] + ((across - left) / width) * (x[1] - x[0]), y[1] - ((down - top) / height) * (y[1] - y[0])];
}

/** Plotly's own zoom moves what is drawn over it, too. */
interface Listening {
  on?: (event: 'plotly_afterplot', listener: () => void) => void;
}

/** Where a plot lies, after each drawing of it. */
export function useFrame(): { frame: Frame | null; drawn: (root: HTMLElement) => void } {
  const [frame, setFrame] = useState<Frame | null>(null);
  const listening = useRef<HTMLElement | null>(null);
  const find = (root: HTMLElement) => setFrame((before) => ((found) => (JSON.stringify(found) === JSON.stringify(before) ? before : found))(frameOf(root)));
  const drawn = (root: HTMLElement) => {
    find(root);
    if (listening.current === root) return;
    listening.current = root;
    (root as Listening).on?.('plotly_afterplot', () => find(root));
  };
  return { frame, drawn };
}
