// One cut in each posture that a cell was measured in.
import type { PosturesDocument } from '../documents';
import { posturesFigure } from '../figures/postures';
import { Section, Table } from '../parts';
import { Plot } from '../plot';
import { dash, fixed, percent, significant } from '../text';

type PostureLimits = PosturesDocument['postures'][number];

const directionName = (name: string) => (name === 'gamma' ? 'γ, about the tool’s axis' : name);

function lowestOf({ limit_mm: limit }: PostureLimits): number | null {
  const found = limit.filter((value) => value !== null);
  return found.length === 0 ? null : Math.min(...found);
}

export function PosturesSection({ document }: { document: PosturesDocument }) {
  const { postures, directions, spindle_speed_rpm: speed } = document;
  return (
    <Section id="postures" heading="Postures side by side" lead="The limits of one cut in each posture that the cell was measured in.">
      <Plot
        which="postures"
        shows="Limit depth over spindle speed by posture"
        caption={`At ${speed.length} spindle speeds, nominal. A gap: no limit up to the deepest cut that was looked at.`}
        draw={(theme) => posturesFigure(document, theme)}
      />
      {directions.length > 0 && (
        <Table
          caption="By direction"
          quiet
          rows={directions}
          columns={[
            { heading: 'Direction', cell: ({ direction }) => directionName(direction) },
            { heading: 'Postures', cell: ({ postures: numbers }) => numbers.join(', ') },
            { heading: 'Limits apart', number: true, cell: ({ spread }) => (spread === null ? dash : percent(spread, 2)) },
            { heading: 'Speeds with every limit', number: true, cell: ({ speeds }) => `${speeds}` },
          ]}
        />
      )}
      <Table
        caption="Postures"
        quiet
        rows={postures}
        columns={[
          { heading: 'Posture', number: true, cell: ({ number }) => `${number}` },
          { heading: 'Tip x, y, z (mm)', cell: ({ tip_mm: tip }) => tip.map((value) => fixed(value, 0)).join(', ') },
          { heading: 'γ (°)', number: true, cell: ({ gamma_deg: gamma }) => fixed(gamma, 1) },
          { heading: 'Joints (°)', cell: ({ joints_deg: joints }) => joints.map((value) => fixed(value, 1)).join(', ') },
          { heading: 'Lowest limit (mm)', number: true, cell: (row) => significant(lowestOf(row)) },
        ]}
      />
    </Section>
  );
}
