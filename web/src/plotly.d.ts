declare module 'plotly.js-cartesian-dist-min' {
  type Data = Record<string, unknown>;
  export function react(root: HTMLElement, data: Data[], layout: Data, config: Data): Promise<HTMLElement>;
}
