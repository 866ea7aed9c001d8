// The page of the sample report: its words, without its plots.
import { renderToString } from 'preact-render-to-string';
import { beforeEach, expect, it, vi } from 'vitest';
import type { Decision, Report } from './documents';
import { Page } from './page';
import { sampleReport } from './report_sample';
import { smoothedBy } from './smooth_views';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

let report: Report;
beforeEach(() => void (report = sampleReport()));

function page(): string {
  return renderToString(<Page report={report} />);
}

/** What a report has where no stage ran. */
function empty(): Report {
  return {
    ...report,
    plan: null,
    frf: null,
    fitted: null,
    measured: null,
    assembly: null,
    modes: null,
    workpiece_modes: null,
    lobes: null,
    forces: null,
    blocks: null,
    smooth: null,
    motion: null,
    cell: null,
    monitor: null,
    calibration: null,
    recordings: null,
    joint: null,
    tools: null,
    sweep: null,
    comparison: null,
    postures: null,
    statistics: null,
    study_points: null,
    explanation: null,
    simulation: null,
    vibration: null,
    coefficients: null,
    stiffness: null,
    assumed: [],
    warnings: [],
    notes: [],
    files: [],
  };
}

it('shows every part of a report', () => {
  const html = page();
  for (const part of [
    '540.08\u202f±\u202f0.11',
    'hit_x_4.csv',
    'double hit',
    '4 flutes, counted as a solid round of 9.6 mm',
    '2·10⁷',
    'class="assembly"',
    '<strong>3 of 6</strong> test cuts with a result',
    'Limited by <strong>mode 8',
    'id="recordings"',
    'class="cell-drawing"',
    'joint 5 is 6.2° above its upper limit of 125°',
    '<strong>2 of 6 poses cannot be taken where the workpiece stands.</strong>',
  ]) {
    expect(html).toContain(part);
  }
  for (const id of [
    'lobes', 'feed', 'program', 'forces', 'smooth', 'cell', 'assembly', 'frf', 'modes', 'pairs', 'monitor', 'calibration',
    'peaks', 'simulation', 'sweep', 'comparison', 'postures', 'probability', 'sensitivity', 'boundary', 'results', 'coefficients', 'stiffness', 'tools', 'joint',
  ]) {
    expect(html).toContain(`<section id="${id}"`);
    expect(html).toContain(`href="#${id}"`);
  }
});

/** The page of the decision alone, with something else in it. */
function decisionPage(change: Partial<Decision>): string {
  const decision = { ...report.plan!.decision!, ...change };
  report = { ...empty(), blocks: report.blocks, plan: { ...report.plan!, recommended: null, alternatives: [], decision } };
  return page();
}

it('shows the decision first: what to run, beside what was programmed and what was not chosen', () => {
  const html = page();
  expect(html.indexOf('<section id="decision"')).toBeLessThan(html.indexOf('<section id="recommendation"'));
  for (const part of [
    'href="#decision"',
    'within every limit',
    '14\u202f200\u202f–\u202f15\u202f600 <small>rpm',
    '18\u202f% less than the 52.4\u202fs programmed',
    '<div class="unknown"><dt>Peak deflection</dt><dd>not known',
    '641 lines, 3 spindle speeds, 38 feeds',
    'Collisions were not checked. Other turns γ move',
    '1234, 2 exact runs in 7.1\u202fs',
    '<small>at most 40\u202fµm</small>',
    '<td class="number">16\u202f400</td><td class="number">3</td><td class="number">≥\u202f12.0</td>',
    'href="#path">block 253 (line 266)</a>',
    'at most 0.4 kW in <a class="block-link" href="#path">block 512 (line 525)</a>',
    'data-plot="gamma-map"',
  ]) {
    expect(html).toContain(part);
  }
  // The warnings stand once: below the card.
  expect(html.split('The measured model is not passive')).toHaveLength(2);
  delete report.plan!.decision;
  expect(page()).not.toContain('id="decision"');
  expect(page().split('The measured model is not passive')).toHaveLength(2);
});

it('says why nothing was decided, and shows the program as it is', () => {
  const html = decisionPage({ status: 'infeasible', reason: 'block 512 (line 525) chatters at every speed', decided: null, stretches: [], gamma_map: null });
  expect(html).toContain('</a> chatters at every speed');
  expect(html).toContain('As programmed</th>');
  for (const part of ['class="figures"', 'As decided', 'Collisions were', 'Stretch by stretch', 'gamma-map']) expect(html).not.toContain(part);
});

it('shows a decision of which no number is known, without a path to go to', () => {
  report.blocks = null;
  const { decided } = report.plan!.decision!;
  const none = Object.fromEntries(Object.keys(decided!).map((key) => [key, null]));
  const outcome = { ...none, violations: [] } as unknown as NonNullable<Decision['decided']>;
  const html = decisionPage({ as_programmed: outcome, decided: outcome, stretches: [], collisions_checked: true });
  expect(html.match(/<div class="unknown">/g)).toHaveLength(10);
  expect(html).not.toContain('href="#path"');
  expect(html).not.toMatch(/NaN|undefined|null|Collisions were/);
  expect(html).toContain('at most 0.4 kW in block 512 (line 525)');
});

it('shows of many stretches those that take longest, and all of them on a click', () => {
  const [stretch] = report.plan!.decision!.stretches;
  const stretches = Array.from({ length: 300 }, (_, i) => ({ ...stretch!, first_block: 2 * i + 1, last_block: 2 * i + 2, cutting_time_s: i }));
  const html = decisionPage({ stretches });
  const table = (caption: string) => html.split(`${caption}</caption>`)[1]!.split('</table>')[0]!;
  expect(table('The 10 stretches that take longest').match(/<tr>/g)).toHaveLength(11);
  expect(table('The 10 stretches that take longest')).toContain('block 599 (line 14)');
  expect(table('Stretch by stretch').match(/<tr>/g)).toHaveLength(201);
  expect(html).toContain('The first 200 of 300.');
});

it('says of a decision that violates limits which, and what is allowed', () => {
  const decided = report.plan!.decision!.decided!;
  const violation = { limit: 'power' as const, block: 12, line: 25, value: 9.1, allowed: 7.5, unit: 'kW' };
  const html = decisionPage({ decided: { ...decided, violations: [violation] } });
  expect(html).toContain('violates 1 limit<');
  expect(html).toContain('<div class="over"><dt>Sustained power</dt>');
  expect(html).toContain('at most 7.5\u202fkW');
  expect(html).toContain('<td>Power</td><td class="number">9.1\u202fkW</td><td class="number">at most 7.5\u202fkW</td>');
});

it('names the worst blocks of a program, and says where none cuts', () => {
  const blocks = report.blocks!;
  const least = Math.min(...blocks.blocks.gain_margin!.filter((gain) => gain !== null));
  expect(page()).toContain(`, gain margin ${Number(least.toPrecision(3))}`);
  expect(page()).toContain('The blocks nearest to chatter');
  expect(page()).toContain('data-plot="limit-over"');
  for (const scan of blocks.limit_over.slice(1)) scan.limit_depth_mm.fill(null);
  expect(page()).toContain('With the cut of block 360 no limit was found anywhere along y, z, γ.');
  const { block, line, x_mm, y_mm, z_mm } = blocks.blocks;
  report.blocks = { ...blocks, blocks: { block, line, x_mm, y_mm, z_mm }, summary: { ...blocks.summary, cutting: 0, unstable: 0 }, limit_over: [] };
  expect(page()).toContain('No block of the program cuts.');
  expect(page()).not.toContain('data-plot="program-limit"');
});

it('needs no lobes beside a program', () => {
  delete report.plan!.facts;
  report.lobes = null;
  expect(page()).toContain('<section id="program"');
});

it('names the chatter frequency once', () => {
  expect(page()).toContain('Chatter would be at 566');
  report.plan!.recommended!.limited_by = 'chatter of mode 8 at 566.4 Hz';
  expect(page()).not.toContain('Chatter would be');
});

it('shows test cuts that disagree before the recommendation they contradict', () => {
  const banner = page().indexOf('<strong>3 of 6 test cuts disagree</strong>');
  expect(banner).toBeGreaterThan(0);
  expect(banner).toBeLessThan(page().indexOf('<dl class="figures">'));
  expect(banner).toBeLessThan(page().indexOf('id="lobes"'));
  expect(page().split('test cuts disagree')).toHaveLength(2);
  delete report.plan!.decision;
  expect(page().indexOf('test cuts disagree')).toBeLessThan(page().indexOf('<dl class="figures">'));
  expect(page().split('test cuts disagree')).toHaveLength(2);
  report.plan!.agreement = { agree: 6, disagree: 0, not_compared: 0 };
  expect(page()).not.toContain('test cuts disagree');
});

it('shows on the card what a machinist sets; the surface is limited in finishing and reported in roughing', () => {
  Object.assign(report.plan!.recommended!, {
    feed_mm_per_min: 4000,
    cutting_speed_m_per_min: 188.4,
    torque_n_m: 0.321,
    power_w: 456,
    surface_error_um: -7.5,
    peak_deflection_um: 23,
  });
  for (const part of ['4000 <small>mm/min', '188 <small>m/min', '0.321 <small>N·m', '456 <small>W', '7.5 µm of overcut', 'up to 23 µm', 'this is a roughing cut']) {
    expect(page()).toContain(part);
  }
  report.plan!.finishing.max_surface_error_um = 8;
  expect(page()).not.toContain('roughing');
  expect(page()).toContain('Permitted: surface error 8 µm.');
});

it('says whose mode it is', () => {
  report.workpiece_modes = report.modes;
  Object.assign(report.plan!.recommended!, { mode: 8, mode_of: 'workpiece', limited_by: '' });
  expect(page()).toContain('Limited by <strong>mode 8 of the workpiece');
  expect(page()).toContain('>8 (workpiece)<');
});

it('shows a fit that found no mode', () => {
  report.modes = { ...report.modes!, modes: [], fit: { ...report.modes!.fit!, converged: false } };
  expect(page()).toContain('The fit did not converge.');
});

it('says why there is no safe depth', () => {
  const { plan, lobes } = report;
  report = { ...empty(), plan: { ...plan!, recommended: null, alternatives: [], reason: 'every speed chatters below 0.05 mm' } };
  expect(page()).toContain('No answer.');
  expect(page()).toContain('every speed chatters below 0.05 mm');
  report.lobes = lobes;
  expect(page()).toContain('No safe depth.');
});

it('has no section for what is not there', () => {
  report = empty();
  expect(page()).not.toContain('<section');
  expect(page()).not.toContain('<nav');
});

it('shows forces beside the limits of the spindle', () => {
  for (const part of [
    'Force on the tool',
    'The blocks with the highest peak force',
    'Deflection by the mean force (µm)',
    '<td>N·m</td>',
    'above the limit',
    'within the limit',
    'Stiffest at <strong>γ = ',
    'out of reach',
    '783 of 800 blocks cut',
    'Mean force on the tool while cutting',
    'Engagement as a table',
    'Before you use these forces',
  ]) {
    expect(page()).toContain(part);
  }
});

it('leaves out of the forces what is not there', () => {
  const { forces } = report;
  report = { ...empty(), forces };
  delete forces!.blocks;
  Object.assign(forces!, { spindle_rotation: null, engagement: [], deflection_um: null, force_on: 'workpiece' });
  expect(page()).toContain('Force on the workpiece');
  for (const part of ['Along the program', 'γ', 'Engagement', 'Deflection by']) expect(page()).not.toContain(part);
  forces!.engagement = [{ height_mm: 1, radius_mm: 3, position_deg: 20, arcs_deg: [] }];
  expect(page()).toContain('No tooth is in the material here.');
  expect(page()).not.toContain('data-plot="engagement"');
});

it('shows a force record beside the forces', () => {
  expect(page()).not.toContain('Measured beside predicted');
  const turn = report.forces!.rotation_deg!;
  const course = turn.map(() => 1.5);
  const none = turn.map(() => null);
  const three = [12.5, -3.25, null] as [number, number, null];
  const each = { mean_n: three, mean_std_n: three, predicted_mean_n: three, peak_n: three, peak_std_n: three, predicted_peak_n: three, rms_n: three, predicted_rms_n: three };
  report.forces!.measured = {
    ...each, file: 'dyno.csv', channels: ['-Fy', '-Fx', 'none'], sample_rate_hz: 10000, from_s: 0.1, to_s: 0.9, revolutions: 79, revolutions_in_record: 100,
    spindle_speed_rpm: 5999.74, spindle_speed_std_rpm: 0.009, wander_deg: 0.16, offset_std_deg: 0.02, air_revolutions: 0, zero_n: three, drift_n: three,
    scatter_n: three, between_teeth_n: three, error_n: three, error_ratio: [0.5, 0.25, null], shape_error_n: three, shape_error_ratio: [0.5, 0.25, null], error_ratio_of_all: 0.5,
    fx_n: course, fy_n: course, fz_n: none, fx_std_n: course, fy_std_n: course, fz_std_n: none,
    harmonics: [{ multiple: 2, frequency_hz: 200, measured_n: three, predicted_n: three }],
  };
  for (const part of ['Measured beside predicted', 'dyno.csv: 79 revolutions', '5999.74 ± 0.009', 'from -Fy, -Fx, none', 'Mean, predicted (N)', 'data-plot="measured"', 'Harmonics of the rotation']) expect(page()).toContain(part);
});

it('says what the simulation found', () => {
  expect(page()).toContain('<strong>stable</strong> Simulated in the time domain');
  report.forces!.vibration = { ...report.forces!.vibration!, verdict: 'chatter', chatter_frequency_hz: 683.4 };
  expect(page()).toContain('<strong>chatter</strong> Chatter at 683 Hz. Simulated');
  report.forces!.vibration = null;
  expect(page()).not.toContain('Simulated in the time domain');
});

it('shows a smoothed program, its methods and its limits', () => {
  for (const part of ['Methods side by side', 'no-joint-jerk', 'Limits used by paper', 'joint 3, jerk', 'Tracking error', 'Joint limits used', '1 statement of the program', 'line 4: M8', 'violates a limit']) {
    expect(page()).toContain(part);
  }
  const [method] = smoothedBy(report.smooth!);
  report = { ...empty(), smooth: { ...report.smooth!, ...method, violations: 0 } };
  delete report.smooth!.methods;
  for (const joint of method.joints) {
    delete joint.max_tracking_error;
    for (const name of ['velocity', 'acceleration', 'jerk'] as const) joint[name].violations = 0;
  }
  for (const of of [method.tip, method.axis]) of.velocity.violations = 0;
  expect(page()).toContain('None of');
  expect(page()).toContain('samples violates a limit.');
  for (const part of ['side by side', 'Tracking error', '<tr class="chatter"']) expect(page()).not.toContain(part);
});

it('shows what the monitor detected', () => {
  for (const part of ['<strong>Chatter</strong> for 1.60 s in 2 alarms', '682 to 696', 'mode 8', 'Alarms by frequency', '9 events, one by one', '3 recordings, 2 classified wrongly', 'missed', 'false']) {
    expect(page()).toContain(part);
  }
  for (const part of ['by ratio, 6 of 6 hops', 'closest: ratio, 2 of 6 hops', 'energy beside the orders, to theirs', 'at most 0.005']) expect(page()).toContain(part);
  const monitor = report.monitor!;
  Object.assign(monitor, { alarms: [], alarm_count: 0, state_times: [{ state: 'stable', reason: null, duration_s: 4 }] });
  expect(page()).toContain('<strong>No alarm</strong> in the 4.00 s that were judged.');
  expect(page()).not.toContain('Alarms by');
});

it('says why the monitor could not tell, and nothing of the cut then', () => {
  expect(page()).toContain('<strong>Cannot tell</strong>: spindle speed unknown, for 0.63 s; samples lost, for 0.42 s.');
  report = { ...empty(), monitor: report.monitor };
  Object.assign(report.monitor!, { alarms: [], alarm_count: 0, events: [], state_times: [{ state: 'blind', reason: 'no-signal', duration_s: 3.2 }] });
  expect(page()).toContain('<strong>Cannot tell</strong>: no usable signal, for 3.20 s.');
  expect(page()).not.toMatch(/no chatter|no alarm|<strong>stable/i);
  report.monitor!.events = [{ ...sampleReport().monitor!.events[0]!, event: 'state', state: 'blind', reason: 'clipped' }];
  expect(page()).toContain('signal at the limit of its converter');
});

it('shows what was commanded and why no speed is suggested', () => {
  report = { ...empty(), monitor: report.monitor };
  const monitor = report.monitor!;
  const chatter = { ...monitor.events[0]!, event: 'state' as const, state: 'chatter' as const, reason: null, suggested_spindle_speed_rpm: null };
  const headings = () => [...page().matchAll(/<th[^>]*>([^<]*)<\/th>/g)].map(([, heading]) => heading);
  monitor.events = [{ ...chatter, no_speed: 'arm' }];
  expect(page()).toContain('<td class="long">no spindle speed avoids it: a mode of the arm</td>');
  expect(headings()).not.toContain('Command');
  monitor.events = [
    { ...chatter, command: 'hold', no_speed: 'unclear', message: 'chatter: stop, and 5 mm out of the cut' },
    { ...chatter, command: 'none', no_speed: 'mode-coupling', message: 'modes couple' },
    { ...chatter, state: 'blind', reason: 'gap', command: null, message: 'blind: nothing is commanded; the hold stays' },
  ];
  expect(headings()).toContain('Command');
  for (const part of ['<td>hold</td>', '<td>none is possible</td>', 'it may be a mode of the arm; chatter: stop, and 5 mm out of the cut', '>modes couple<', 'samples lost; blind: nothing is commanded; the hold stays']) {
    expect(page()).toContain(part);
  }
  monitor.alarms[0]!.suggested_spindle_speed_rpm = null;
  monitor.alarms[0]!.no_speed = 'unclear';
  monitor.alarms[0]!.hidden = 'locked';
  expect(page()).toContain('locked to the rotation; no spindle speed is suggested: it may be a mode of the arm');
});

it('says of a blind monitor in words what it lacks, and no score', () => {
  report = { ...empty(), monitor: report.monitor };
  const event = report.monitor!.events[0]!;
  report.monitor!.events = [
    { ...event, event: 'state', state: 'blind', reason: 'no-signal', score: 0, threshold: 17.9 },
    { ...event, event: 'fault', state: 'stable', reason: null, faults: ['speed-unknown', 'clipped'] },
  ];
  const rows = [...page().split('Events</caption>')[1]!.matchAll(/<tr>(.*?)<\/tr>/g)].map(([, row]) => row!.replace(/<[^>]*>/g, '|'));
  expect(rows[1]).toContain('|cannot\u00a0tell||–||17.9|');
  expect(rows[2]).toContain('input: spindle speed unknown, signal at the limit of its converter');
});

it('has no column that says nothing, and no navigation to a single section', () => {
  report = { ...empty(), monitor: report.monitor };
  expect(page()).toContain('>Mode</th>');
  expect(page()).not.toContain('<nav');
  for (const row of [...report.monitor!.events, ...report.monitor!.alarms]) Object.assign(row, { mode: null, hidden: null, no_speed: null });
  expect(page()).not.toContain('>Mode</th>');
});

it('says where no threshold works, and of what its numbers are', () => {
  expect(page()).not.toContain('Not calibrated');
  report = { ...empty(), calibration: report.calibration };
  Object.assign(report.calibration!, { status: 'not-verified', reason: '0 of 3 recordings with chatter found in the verifying half' });
  for (const part of ['<strong>Not calibrated</strong>: 0 of 3 recordings with chatter found in the verifying half.', 'Best that was tried', 'the mark is the best one']) {
    expect(page()).toContain(part);
  }
  for (const part of ['Chatter is', 'chosen', 'How the threshold was set']) expect(page()).not.toContain(part);
});

it('lists what was assumed once, near the top, with the key to give', () => {
  const html = page();
  const box = html.indexOf('aria-label="Assumed"');
  expect(box).toBeGreaterThan(html.indexOf('id="decision"'));
  expect(box).toBeLessThan(html.indexOf('<section id="monitor"'));
  expect(html).toContain('<td class="long">the bounding box of the program, up to program zero</td><td><code>stock</code></td>');
  expect(html).toContain('<code>loss_factor</code> of assembly.toml');
  expect(html.split('Accelerations of the joints')).toHaveLength(2); // of the cell's own list
  report.assumed = [{ what: 'Collisions', taken: 'none', key: 'geometry', file: 'cell.toml' }];
  report.cell = null;
  expect(page()).not.toContain('aria-label="Assumed"'); // the decision has said it
  delete report.plan!.decision;
  expect(page()).toContain('<code>geometry</code> of cell.toml');
});

it('shows warnings and notes that no document holds', () => {
  expect(page()).toContain('A note that no document holds.');
  report = { ...empty(), warnings: ['a warning of its own'], lobes: report.lobes };
  expect(page()).toContain('Before you use these numbers</h2><ul><li>a warning of its own');
});

it('names peaks, and says what the chatter is', () => {
  for (const part of ['<strong>Chatter of mode 8</strong> at 568.10 Hz', 'the surface wave that the previous tooth cut sustains it', 'mode 8 at 566.40 Hz + 3 × rotation', '<td>cut or chatter</td><td>the cut, or chatter</td>', '4 × rotation; mode 8 at 566.40 Hz']) {
    expect(page()).toContain(part);
  }
  report = { ...empty(), explanation: { ...report.explanation!, state: 'no chatter', chatter: null } };
  expect(page()).toContain('No peak is chatter of a known mode.');
  expect(page()).not.toContain('By the model');
});

it('shows a cut in time', () => {
  for (const part of ['<span class="verdict chatter">chatter</span> Chatter at 566.4 Hz, 23.1 µm. A small vibration grows', 'data-plot="simulated"', 'data-plot="simulated-spectrum"', '<td>leave</td><td class="number">12.4</td>']) {
    expect(page()).toContain(part);
  }
  report = { ...empty(), simulation: { ...report.simulation!, verdict: 'undecided', chatter_frequency_hz: null, walls: [], diverged: true } };
  for (const part of ['Simulated for longer it would show.', 'grew beyond every bound']) expect(page()).toContain(part);
  for (const part of ['data-plot', 'Surface left']) expect(page()).not.toContain(part);
});

it('shows sweeps, methods, and points that were asked for', () => {
  for (const part of ['<td class="number">9200</td><td class="number">3</td><td><span class="verdict chatter">', 'Radial depth (mm)', 'multi-frequency: takes no helix', 'Methods that do not take this cut']) {
    expect(page()).toContain(part);
  }
  report.lobes!.points = report.sweep!.points.map((point) => ({ ...point, axial_depth_mm: 1.5, limit_depth_mm: 1.25 }));
  report = { ...empty(), lobes: report.lobes };
  expect(page()).toContain('Points that were asked for');
  expect(page()).toContain('<td class="number">1.5</td><td class="number">1.250</td>');
});

it('shows values that were identified, with their deviations', () => {
  for (const part of [
    '<td>tangential</td><td class="number">712.0\u202f±\u202f7.1</td>',
    'The coefficients depend on the spindle speed',
    'At 6000 rpm, 4 slots',
    '99.84\u202f% of the displacement is explained',
    '<td><strong>no</strong></td><td class="long">no load turns it</td>',
    'Translational stiffness</td><td class="number">2.1·10⁷</td>',
    'At 2 lines the measured holder would create energy',
  ]) {
    expect(page()).toContain(part);
  }
});

it('shows tools side by side, and why one has no result', () => {
  for (const part of ['data-plot="tools"', 'overhang_mm is above the 80 mm', 'long: Two modes are closer than their half widths.', 'Modes of every tool']) {
    expect(page()).toContain(part);
  }
  for (const tool of report.tools!.tools) Object.assign(tool, { peak_um_per_n: null, peak_hz: null, lowest_limit_mm: null, recommended: null, modes: [], notes: [] });
  report = { ...empty(), tools: report.tools };
  for (const part of ['data-plot', 'Modes of every tool', 'Removal (mm³/s)']) expect(page()).not.toContain(part);
});

it('shows of a study what its points say, and only that', () => {
  const { statistics, study_points } = report;
  report = { ...empty(), statistics, study_points };
  for (const part of [
    'Robust optimum: limit@10000 at tool.teeth = 2',
    '<li>limit@12000 at tool.teeth = 4, cut.radial_depth_mm = 6: 2 of 66 samples</li>',
    'limit@12000 at tool.teeth = 3: does not vary: no key matters.',
    '2371 evaluations. The full grid of the same steps has 35\u202f937, 15.2 times as many.',
    '400 of 6200 points of the boundary, evenly chosen.',
    '60 of 20000 points, evenly chosen. 3 of all 20000 points were rejected',
  ]) {
    expect(page()).toContain(part);
  }
  report = { ...empty(), study_points };
  expect(page()).toContain('id="results"');
  for (const id of ['probability', 'sensitivity', 'boundary']) expect(page()).not.toContain(`id="${id}"`);
  report = { ...empty(), statistics: { document: 'statistics/1', boundary: { ...statistics!.boundary!, points: 0, complete: false } } };
  for (const part of ['The most points were reached', 'No point of the coarse grid']) expect(page()).toContain(part);
  for (const part of ['data-plot', 'id="results"']) expect(page()).not.toContain(part);
});

it('has no column of grades or shares where a verb knows none', () => {
  report = { ...empty(), frf: { ...report.frf!, grades: {} }, fitted: report.fitted, modes: report.modes };
  expect(page()).not.toContain('Error of the fit');
  report.modes!.fit!.relative_error_by_frf = { xx: 0.02 };
  expect(page()).toContain('Error of the fit');
  for (const part of ['not graded', 'Share in the limit', '>Force<']) expect(page()).not.toContain(part);
});

it('keeps markup in texts as text', () => {
  const evil = '</script><img src=x onerror=alert(1)>';
  report = JSON.parse(JSON.stringify(report), (_, value: unknown) => (typeof value === 'string' && /^[A-Za-z .]{12,}$/.test(value) ? evil : value)) as Report;
  expect(page()).not.toContain('<img');
  expect(page()).toContain('&lt;img');
});
