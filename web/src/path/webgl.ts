// Draws the path with WebGL: all cutting blocks in one geometry with a colour a block.
import { BufferAttribute, BufferGeometry, Color, ColorManagement, LinearSRGBColorSpace, LineBasicMaterial, LineSegments, Scene, WebGLRenderer, type OrthographicCamera } from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { inAir, type PathColours, type PathData } from './contract';
import { cutting, drawn, isUnstable } from './project';
import type { Painter } from './painter';

/** Both ends of each block. */
function segments({ ends }: PathData, blocks: number[]): Float32Array {
  const out = new Float32Array(6 * blocks.length);
  blocks.forEach((i, k) => out.set(ends.subarray(3 * i - 3, 3 * i + 3), 6 * k));
  return out;
}

function wide(positions: Float32Array, material: LineMaterial, order: number): LineSegments2 {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(positions);
  const lines = new LineSegments2(geometry, material);
  lines.renderOrder = order;
  lines.frustumCulled = false;
  return lines;
}

const many = 8000; // wide lines of more blocks take a browser without a graphics card a second a picture, and cover each other anyway

interface Cuts {
  lines: LineSegments | LineSegments2;
  colour: (values: Float32Array) => void; // red, green, blue of both ends of each
}

/** All cutting blocks as one object. */
function cutsOf(positions: Float32Array): Cuts {
  if (positions.length <= 6 * many) {
    const lines = wide(positions, new LineMaterial({ linewidth: 3, vertexColors: true }), 1);
    return { lines, colour: (values) => void lines.geometry.setColors(values) };
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
  lines.renderOrder = 1;
  return { lines, colour: (values) => void geometry.setAttribute('color', new BufferAttribute(values, 3)) };
}

/** What is drawn of a path. */
class Lines {
  private readonly cuts: number[];
  private readonly cut: Cuts;
  private readonly air = new LineBasicMaterial({ transparent: true, opacity: 0.6 });
  private readonly halo: LineMaterial;
  readonly scene = new Scene();

  constructor(data: PathData) {
    this.cuts = drawn(data, cutting);
    this.cut = cutsOf(segments(data, this.cuts));
    this.halo = new LineMaterial({ linewidth: this.cuts.length > many ? 4 : 8, depthWrite: false });
    const airGeometry = new BufferGeometry();
    airGeometry.setAttribute('position', new BufferAttribute(segments(data, drawn(data, (kind) => kind === inAir)), 3));
    this.scene.add(new LineSegments(airGeometry, this.air), wide(segments(data, drawn(data, isUnstable)), this.halo, 0), this.cut.lines);
  }

  paint({ blocks, air, unstable }: PathColours): void {
    const both = new Float32Array(6 * this.cuts.length);
    this.cuts.forEach((i, k) => {
      for (let c = 0; c < 3; ++c) both[6 * k + c] = both[6 * k + 3 + c] = blocks[3 * i + c]! / 255;
    });
    this.cut.colour(both);
    this.air.color = new Color(air);
    this.halo.color = new Color(unstable);
  }

  dispose(): void {
    for (const child of this.scene.children) {
      const { geometry, material } = child as LineSegments;
      geometry.dispose();
      (material as LineBasicMaterial).dispose();
    }
  }
}

/** null where there is no WebGL. */
export function webglPainter(data: PathData): Painter | null {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('webgl2', { antialias: true, alpha: true, preserveDrawingBuffer: true });
  if (context === null) return null;
  ColorManagement.enabled = false; // the colours are those of the page
  const renderer = new WebGLRenderer({ canvas, context, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.outputColorSpace = LinearSRGBColorSpace;
  renderer.setClearColor(0, 0);

  let lines = new Lines(data);
  return {
    name: 'webgl',
    canvas,
    resize: (width, height, ratio) => {
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height, false);
    },
    load: (given) => {
      lines.dispose();
      lines = new Lines(given);
    },
    paint: (colours) => lines.paint(colours),
    draw: (camera: OrthographicCamera) => renderer.render(lines.scene, camera),
    dispose: () => renderer.dispose(),
  };
}
