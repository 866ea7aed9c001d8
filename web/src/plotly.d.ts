declare module 'plotly.js-cartesian-dist-min' {
  type Data = Record<string, unknown>;
  export function react(root: HTMLElement, data: Data[], layout: Data, config: Data): Promise<HTMLElement>;
  export function relayout(root: HTMLElement, update: Data): Promise<HTMLElement>;
  export const Plots: { resize(root: HTMLElement): Promise<void> };
}
