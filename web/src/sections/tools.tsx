// Tools in one holder, side by side.
import type { ToolRow, ToolsDocument } from '../documents';
import { toolsFigure } from '../figures/tools';
import { Bullets, DetailsTable, Section, Table } from '../parts';
import { Plot } from '../plot';
import { dash, fixed, percent, significant } from '../text';

function remark({ failure, reason, recommended }: ToolRow): string {
  return failure ?? recommended?.limited_by ?? reason ?? dash;
}

function Modes({ tools }: { tools: ToolRow[] }) {
  const rows = tools.flatMap(({ tool, modes, fit_relative_error: error }) => modes.map((mode) => ({ tool, error, ...mode })));
  return (
    <DetailsTable
      summary="Modes of every tool"
      caption="Modes by tool"
      rows={rows}
      columns={[
        { heading: 'Tool', cell: ({ tool }) => tool },
        { heading: 'Frequency (Hz)', number: true, cell: (mode) => fixed(mode.frequency_hz, 1) },
        { heading: 'Damping', number: true, cell: (mode) => percent(mode.damping_ratio, 2) },
        { heading: 'Error of the fit', number: true, cell: ({ error }) => percent(error, 2) },
      ]}
    />
  );
}

export function ToolsSection({ document: { tools, holder } }: { document: ToolsDocument }) {
  const notes = tools.flatMap(({ tool, notes: own }) => own.map((note) => `${tool}: ${note}`));
  return (
    <Section id="tools" heading="Tools in the holder" lead="What each tool of the list comes to in the same holder.">
      {tools.some(({ peak_um_per_n: peak }) => peak !== null) && (
        <Plot
          which="tools"
          shows="Compliance, limit depth and removal rate by tool"
          caption="Less compliance lets a cut be deeper; the removal rate is that of the recommended cut."
          draw={(theme) => toolsFigure(tools, theme)}
        />
      )}
      <Table
        caption="Tools"
        quiet
        rows={tools}
        rowClass={({ failure }) => (failure === null ? '' : 'rejected')}
        columns={[
          { heading: 'Tool', cell: ({ tool }) => tool },
          { heading: 'Teeth', number: true, optional: true, cell: ({ teeth }) => fixed(teeth, 0) },
          { heading: 'Diameter (mm)', number: true, cell: (row) => significant(row.diameter_mm) },
          { heading: 'Overhang (mm)', number: true, cell: (row) => significant(row.overhang_mm) },
          { heading: 'Peak (µm/N)', number: true, optional: true, cell: (row) => significant(row.peak_um_per_n) },
          { heading: 'at (Hz)', number: true, optional: true, cell: (row) => fixed(row.peak_hz, 1) },
          { heading: 'Lowest limit (mm)', number: true, optional: true, cell: (row) => significant(row.lowest_limit_mm) },
          { heading: 'Speed (rpm)', number: true, optional: true, cell: ({ recommended }) => fixed(recommended?.spindle_speed_rpm ?? null, 0) },
          { heading: 'Depth (mm)', number: true, optional: true, cell: ({ recommended }) => significant(recommended?.axial_depth_mm ?? null) },
          { heading: 'Removal (mm³/s)', number: true, optional: true, cell: ({ recommended }) => significant(recommended?.removal_rate_mm3_per_s ?? null) },
          { heading: 'Limited by', long: true, optional: true, cell: remark },
        ]}
      />
      <Modes tools={tools} />
      <Bullets texts={notes} />
      {holder && holder.unreliable_hz.length > 0 && (
        <p>At {holder.unreliable_hz.length} lines the holder's receptances are unreliable: a small error of the measurement became a large one.</p>
      )}
    </Section>
  );
}
