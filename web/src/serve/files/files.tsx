// The files of the folder, by kind, with what can be done with each.
import type { ComponentChildren } from 'preact';
import { Table } from '../../parts';
import { useServe } from '../context';
import { fileKinds, type FileEntry, type Verb } from '../documents';
import { bytesText, timeText, View } from '../pieces';
import { href } from '../route';
import { documentText, isEditable, isRecording, kindNames, runsOf } from '../verbs';
import { Arrivals, useReceived } from './arrivals';

/** In the order of kinds, of each kind by path; `name`: of the kind, `first`: of it. */
export function byKind(files: FileEntry[]): (FileEntry & { name: string; first: boolean })[] {
  return fileKinds.flatMap((kind) => {
    const some = files.filter((file) => file.kind === kind || (kind === 'other' && !fileKinds.includes(file.kind))).sort((a, b) => a.path.localeCompare(b.path));
    return some.map((file, i) => ({ ...file, name: kindNames[kind], first: i === 0 }));
  });
}

interface FilesProps {
  verbs: Verb[];
  describe: (path: string) => void;
}

function Actions({ file, verbs, describe }: FilesProps & { file: FileEntry }) {
  const { kind, path } = file;
  const runs = runsOf(verbs, kind);
  const links: ComponentChildren[] = [];
  const link = (address: string, name: string) => (
    <a href={address} aria-label={`${name}: ${path}`}>
      {name}
    </a>
  );
  if (kind === 'job') links.push(link(href('overview', path), 'Overview'));
  if (kind === 'lobes' || kind === 'job') links.push(link(href('lobes', path), 'Lobes'));
  if (kind === 'hits') links.push(link(href('tap', path), 'Tap test'));
  if (kind === 'monitor') links.push(link(href('monitor', path), 'Monitor'));
  if (isEditable(path)) links.push(link(href('job', path), runs.length > 0 ? 'Edit and run' : 'Edit'));
  else if (runs.length > 0 && kind !== 'record') links.push(link(href('job', path), runs.length === 1 ? runs[0]!.verb.does : 'Run'));
  if (isRecording(file) || kind === 'frf') {
    links.push(
      <button type="button" class="link" aria-label={`What is it: ${path}`} onClick={() => describe(path)}>
        What is it
      </button>,
    );
  }
  return <span class="actions">{links}</span>;
}

export function FilesTable({ files, verbs, describe }: FilesProps & { files: FileEntry[] }) {
  return (
    <Table
      caption="Files by kind"
      quiet
      rows={byKind(files)}
      columns={[
        { heading: 'Kind', cell: ({ name, first }) => (first ? <strong>{name}</strong> : <span class="quiet">{name}</span>) },
        {
          heading: 'File',
          cell: (file) => (
            <>
              <code>{file.path}</code>
              {documentText(file) !== '' && <span class="muted"> {documentText(file)}</span>}
            </>
          ),
        },
        { heading: 'What to do with it', cell: (file) => <Actions file={file} verbs={verbs} describe={describe} /> },
        { heading: 'Size', number: true, cell: ({ bytes }) => bytesText(bytes) },
        { heading: 'Changed', cell: ({ modified }) => timeText(modified) },
      ]}
    />
  );
}

/** Files are chosen here, or dropped anywhere on the page. */
export function FileInput() {
  const { take } = useServe();
  return (
    <label class="drop">
      <span>Drop files anywhere on this page, or choose them: hits, FRFs, NC programs, recordings</span>
      <input
        type="file"
        multiple
        onChange={({ currentTarget }) => {
          take([...(currentTarget.files ?? [])]);
          currentTarget.value = '';
        }}
      />
    </label>
  );
}

export function FilesView() {
  const { folder, verbs } = useServe();
  const { describe, ...received } = useReceived();
  const files = folder?.files ?? [];
  return (
    <View heading={folder ? `Files of ${folder.folder}` : 'Files'} lead="What robomill found, and what to do with it.">
      <section aria-label="More files">
        <FileInput />
      </section>
      <Arrivals {...received} taken={files.map(({ path }) => path)} />
      {folder && (
        <section aria-label="Files">
          <h2>In the folder</h2>
          {files.length === 0 ? (
            <p>
              The folder is empty. Drop files on this page, or start with <code>robomill init job</code>.
            </p>
          ) : (
            <FilesTable files={files} verbs={verbs} describe={describe} />
          )}
          {folder.files_left_out > 0 && <p class="notice">{folder.files_left_out} more files are not listed.</p>}
        </section>
      )}
    </View>
  );
}
