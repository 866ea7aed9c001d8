// What was taken because nobody said it.
import type { Assumption } from '../documents';
import { Table } from '../parts';
import { dash } from '../text';

function Where({ of: { key, file } }: { of: Assumption }) {
  if (key === null) return <>{dash}</>;
  return (
    <>
      <code>{key}</code>
      {file !== null && ` of ${file}`}
    </>
  );
}

export function AssumedBox({ assumed }: { assumed: Assumption[] }) {
  if (assumed.length === 0) return null;
  return (
    <aside class="assumed" aria-label="Assumed">
      <h2>Assumed, because not given</h2>
      <Table
        caption="Assumed, because not given"
        quiet
        rows={assumed}
        columns={[
          { heading: 'What', cell: ({ what }) => what },
          { heading: 'Taken as', cell: ({ taken }) => taken },
          { heading: 'To be given as', cell: (one) => <Where of={one} /> },
        ]}
      />
    </aside>
  );
}
