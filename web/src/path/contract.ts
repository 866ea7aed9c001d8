// What the page and the script that draws a path in three dimensions say to each other. That script stands in reports with a path alone.
export const inAir = 0;
export const stable = 1;
export const unstable = 2;

export interface PathData {
  ends: Float32Array; // x, y, z where each block ends [mm]; NaN: not known
  kinds: Uint8Array; // of each block: inAir, stable, unstable
}

export interface PathColours {
  blocks: Uint8Array; // red, green, blue of each block
  air: string;
  unstable: string; // around blocks that are unstable
  text: string;
  panel: string; // behind the path
}

export type Side = 'corner' | 'above' | 'front' | 'right';

export interface PathEvents {
  picked: (index: number) => void;
  hovered: (index: number | null) => void;
  painter: (name: 'webgl' | 'canvas') => void; // what draws: WebGL, or where there is none a plane canvas
}

export interface PathView {
  paint(colours: PathColours): void; // before it returns
  judge(kinds: Uint8Array): void; // other kinds at the same places; a paint follows
  mark(selected: number | null): void;
  fit(side?: Side): void;
  key(name: string): boolean; // whether it was one
  dispose(): void;
}

export type OpenPath = (root: HTMLElement, data: PathData, events: PathEvents) => PathView;

declare global {
  interface Window {
    robomillPath?: OpenPath;
  }
}
