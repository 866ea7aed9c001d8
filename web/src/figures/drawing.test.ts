import { describe, expect, it } from 'vitest';
import type { Assembly, Joint, Segment } from '../views';
import { AssemblyDrawing } from './drawing';
import { layOut, sideBySide, viewWidth, type Box, type Point, type Shape } from './drawing_layout';

/** Numbers in [0, 1), the same in every run (mulberry32). */
function seeded(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}

function segment(part: Segment['part'], length_mm: number, diameter_mm: number, more: Partial<Segment> = {}): Segment {
  return {
    part,
    count: 1,
    length_mm,
    diameter_mm,
    inner_diameter_mm: 0,
    youngs_modulus_gpa: 200,
    density_kg_per_m3: 7800,
    poissons_ratio: 0.3,
    loss_factor: 0,
    beam: 'timoshenko',
    ...more,
  };
}

const joint: Joint = {
  translational_stiffness_n_per_m: 1e7,
  translational_damping_n_s_per_m: 0,
  rotational_stiffness_n_m_per_rad: 1e5,
  rotational_damping_n_m_s_per_rad: 0,
  cross_stiffness_n_per_rad: 0,
  points: 1,
  shank: [],
};

function assembled(tool: Segment[], holder: Assembly['holder']['kind'] | Segment[], more: Partial<Assembly> = {}): Assembly {
  const held = Array.isArray(holder) ? { kind: 'segments' as const, segments: holder } : { kind: holder, segments: [] };
  return { tool, joint: null, holder: { ...held, file: '' }, peaks: [], suspect_lines: 0, unreliable_lines: 0, notes: [], ...more };
}

function ofKind(shapes: Shape[], kind: string): Shape[] {
  return shapes.filter((shape) => 'kind' in shape && shape.kind === kind);
}

function boxes(shapes: Shape[], ...kinds: string[]): Box[] {
  return shapes.filter((shape): shape is Box => shape.shape === 'box' && (kinds.length === 0 || kinds.includes(shape.kind)));
}

function pointsOf(shape: Shape): Point[] {
  if (shape.shape === 'box') return [[shape.x, shape.y], [shape.x + shape.width, shape.y + shape.height]];
  if (shape.shape === 'line') return [shape.from, shape.to];
  return shape.shape === 'path' ? shape.points : [shape.at];
}

function outside(shapes: Shape[], height: number): Shape[] {
  return shapes.filter((shape) => pointsOf(shape).some(([x, y]) => x < -1e-9 || x > viewWidth + 1e-9 || y < 0 || y > height));
}

function texts(shapes: Shape[]): string[] {
  return shapes.flatMap((shape) => (shape.shape === 'label' ? [shape.text] : []));
}

describe('labels side by side', () => {
  // Kept in order, none over another, within the room where all fit; and a label that is not at its target could not
  // be moved towards it: it touches a neighbour or the edge on that side.
  it('are as near to their targets as the others allow', () => {
    const random = seeded(3);
    for (let round = 0; round < 300; ++round) {
      const count = 1 + Math.floor(12 * random());
      const targets = Array.from({ length: count }, () => 900 * random()).sort((a, b) => a - b);
      const widths = Array.from({ length: count }, () => 5 + 65 * random());
      const at = sideBySide(targets, widths, 0, 900);
      expect(at).toHaveLength(count);
      const left = (i: number) => (i < count ? at[i]! - 0.5 * widths[i]! : 900);
      const right = (i: number) => (i < 0 ? 0 : at[i]! + 0.5 * widths[i]!);
      for (let i = 0; i <= count; ++i) expect(left(i) - right(i - 1)).toBeGreaterThan(-1e-9);
      targets.forEach((target, i) => {
        const wish = target - at[i]!;
        if (Math.abs(wish) < 1e-9) return;
        const room = wish > 0 ? left(i + 1) - right(i) : left(i) - right(i - 1);
        expect(room).toBeLessThan(1e-9);
      });
    }
  });
  // The sum of the squares itself, against other arrangements without overlap.
  it('are nearer than any other arrangement', () => {
    const random = seeded(4);
    for (let round = 0; round < 100; ++round) {
      const targets = Array.from({ length: 8 }, () => 900 * random()).sort((a, b) => a - b);
      const widths = targets.map(() => 50 + 50 * random());
      const distance = (at: number[]) => at.reduce((sum, centre, i) => sum + (centre - targets[i]!) ** 2, 0);
      const best = sideBySide(targets, widths, 0, 900);
      for (let other = 0; other < 20; ++other) {
        const elsewhere = sideBySide(targets.map((target) => target + 60 * (random() - 0.5)), widths, 0, 900);
        expect(distance(best)).toBeLessThan(distance(elsewhere) + 1e-6);
      }
    }
  });
  it('stay where they are if they do not touch', () => {
    expect(sideBySide([100, 300], [50, 50], 0, 900)).toEqual([100, 300]);
    expect(sideBySide([100, 100], [50, 50], 0, 900)).toEqual([75, 125]);
    expect(sideBySide([], [], 0, 900)).toEqual([]);
  });
});

describe('the drawing of an assembly', () => {
  it('has one scale for lengths and diameters, whatever the proportions', () => {
    for (const [stretch, girth] of [[0.05, 1], [1, 1], [40, 1], [1, 20]] as const) {
      const tool = [segment('tool', 30 * stretch, 12 * girth, { flutes: 4 }), segment('tool', 60 * stretch, 16 * girth, { inner_diameter_mm: 4 })];
      const holder = [segment('holder', 40 * stretch, 40, { inner_diameter_mm: 16 })];
      const { shapes, height } = layOut(assembled(tool, holder, { joint }));
      const parts = boxes(shapes, 'tool', 'holder');
      const scale = parts[0]!.height / tool[0]!.diameter_mm;
      [...tool, ...holder].forEach(({ length_mm, diameter_mm }, i) => {
        expect(parts[i]!.width).toBeCloseTo(scale * length_mm, 6);
        expect(parts[i]!.height).toBeCloseTo(scale * diameter_mm, 6);
      });
      expect(parts).toHaveLength(3);
      expect(parts[1]!.x).toBeCloseTo(parts[0]!.x + parts[0]!.width, 6);
      expect(boxes(shapes, 'flutes')).toMatchObject([{ x: parts[0]!.x, width: parts[0]!.width }]);
      expect(outside(shapes, height)).toEqual([]);
    }
  });
  it('has room for what holds a long and thin tool', () => {
    for (const kind of ['wall', 'measured'] as const) {
      for (const held of [null, joint]) {
        const { shapes, height } = layOut(assembled([segment('tool', 100, 2)], kind, { joint: held }));
        expect(outside(shapes, height)).toEqual([]);
        const behind = boxes(shapes, kind)[0]!;
        for (const [, y] of ofKind(shapes, 'spring').flatMap(pointsOf)) {
          expect(y).toBeGreaterThan(behind.y);
          expect(y).toBeLessThan(behind.y + behind.height);
        }
      }
    }
  });
  it('has a bar as long as it says', () => {
    for (const length of [3, 40, 700]) {
      const { shapes } = layOut(assembled([segment('tool', length, length / 8)], 'wall'));
      const scale = boxes(shapes, 'tool')[0]!.width / length;
      const bar = texts(shapes).pop()!;
      expect(bar).toMatch(/^0?\.?0*[125]0* mm$/);
      expect(boxes(shapes, 'scale')[0]!.width).toBeCloseTo(scale * parseFloat(bar), 6);
    }
  });
  it('says lengths and diameters, with bores, and what the joint is', () => {
    const tool = [segment('tool', 30, 12, { flutes: 4 }), segment('tool', 22.5, 16, { inner_diameter_mm: 4.25 })];
    const { shapes, words } = layOut(assembled(tool, [segment('holder', 40, 40)], { joint: { ...joint, translational_damping_n_s_per_m: 60 } }));
    const said = ['⌀\u202f12', '⌀\u202f16/4.25', '⌀\u202f40', '30', '22.5', '40', 'tool 52.5 mm', 'holder 40 mm'];
    expect(texts(shapes)).toEqual(expect.arrayContaining(said));
    expect(texts(shapes)).toContain('Shift: k 1·10⁷ N/m, c 60 N·s/m');
    expect(texts(shapes)).toContain('Rotation: k 1·10⁵ N·m/rad, c 0 N·m·s/rad');
    expect(words).toBe('Tool of 52.5 mm in 2 segments, on an elastic joint to a holder of 40 mm in 1 segment on a rigid wall');
  });
  it('shows what holds the tool', () => {
    const tool = [segment('tool', 100, 12)];
    const wall = layOut(assembled(tool, 'wall'));
    expect(wall.words).toBe('Tool of 100 mm in 1 segment, joined rigidly to a rigid wall');
    expect(texts(wall.shapes)).toContain('rigid joint');
    const free = layOut(assembled(tool, 'free'));
    expect(free.words).toBe('Tool of 100 mm in 1 segment, held by nothing');
    expect(ofKind(free.shapes, 'wall')).toEqual([]);
    expect(boxes(wall.shapes, 'wall')).toHaveLength(1);
    expect(ofKind(wall.shapes, 'spring')).toEqual([]);
    const measured = layOut(assembled(tool, 'measured', { joint }));
    expect(measured.words).toBe('Tool of 100 mm in 1 segment, on an elastic joint to a measured holder');
    expect(boxes(measured.shapes, 'wall')).toEqual([]);
    expect(boxes(measured.shapes, 'measured')).toHaveLength(1);
    expect(ofKind(measured.shapes, 'spring')).not.toEqual([]);
  });
  it('marks every point of a distributed joint on both sides of the shank', () => {
    const along = { ...joint, points: 5, insertion_length_mm: 30, shank: [segment('shank', 30, 12)] };
    const { shapes, words } = layOut(assembled([segment('tool', 60, 12)], [segment('holder', 50, 32, { inner_diameter_mm: 12 })], { joint: along }));
    const shank = boxes(shapes, 'tool shank')[0]!;
    const dots = shapes.flatMap((shape) => (shape.shape === 'dot' ? [shape.at] : []));
    expect(dots).toHaveLength(10);
    dots.forEach(([x, y], i) => {
      expect(x).toBeCloseTo(shank.x + (shank.width * Math.floor(i / 2)) / 4, 6);
      expect(y).toBeCloseTo(shank.y + (i % 2) * shank.height, 6);
    });
    expect(ofKind(shapes, 'plate')).toHaveLength(1); // of the wall; the joint has no gap
    expect(words).toContain('in an elastic joint of 5 points on a holder of 50 mm');
  });
  it('leaves labels without room to the table', () => {
    const many = Array.from({ length: 100 }, (_, i) => segment('tool', 1 + (i % 3), 10 + (i % 7)));
    const { shapes } = layOut(assembled(many, 'wall'));
    expect(texts(shapes)).toEqual(['rigid joint', 'tool 199 mm', '20 mm']);
    expect(boxes(shapes, 'tool')).toHaveLength(100);
  });
  it('becomes SVG with one decimal and a caption', () => {
    const page = JSON.stringify(AssemblyDrawing({ assembly: assembled([segment('tool', 100, 12)], 'measured', { joint }) }));
    expect(page).toContain('"viewBox":"0 0 900 ');
    expect(page).toContain('"x":"24.0"');
    expect(page).toContain('To scale, but for');
    expect(page).not.toMatch(/NaN|undefined|Infinity|\d\.\d{2}/);
  });
});
