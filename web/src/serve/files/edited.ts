// The file that a view edits.
import { useEffect, useMemo, useState } from 'preact/hooks';
import type { Api } from '../api';
import { drafts } from './drafts';
import { EditedFile } from './edited_file';

export function useEdited(api: Api, path: string): EditedFile {
  const [, redraw] = useState(0);
  const file = useMemo(() => new EditedFile(api, path, drafts, () => redraw((times) => times + 1)), [path]);
  useEffect(() => {
    void file.open();
    return () => file.close();
  }, [file]);
  return file;
}
