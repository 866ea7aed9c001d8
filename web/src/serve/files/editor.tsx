// A text with line numbers, the line of an error marked.
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';

const line_px = 20; // as page.css has it

interface EditorProps {
  label: string;
  text: string;
  type: (text: string) => void;
  wrong: { line: number; text: string } | null;
  jump: number; // counts requests to go to the wrong line
}

/** Where in the text a line (from 1) begins and ends. */
export function lineRange(text: string, line: number): [number, number] {
  let begin = 0;
  for (let i = 1; i < line; ++i) {
    const next = text.indexOf('\n', begin);
    if (next < 0) break;
    begin = next + 1;
  }
  const end = text.indexOf('\n', begin);
  return [begin, end < 0 ? text.length : end];
}

export function lineNumbers(text: string): string {
  return Array.from({ length: text.split('\n').length }, (_, i) => i + 1).join('\n');
}

export function Editor({ label, text, type, wrong, jump }: EditorProps) {
  const area = useRef<HTMLTextAreaElement>(null);
  const beside = useRef<HTMLDivElement>(null);
  const scroll = () => {
    if (beside.current && area.current) beside.current.style.transform = `translateY(${-area.current.scrollTop}px)`;
  };
  useLayoutEffect(scroll, [text]);
  useEffect(() => {
    if (jump === 0 || wrong === null || !area.current) return;
    area.current.focus();
    area.current.setSelectionRange(...lineRange(text, wrong.line));
    area.current.scrollTop = Math.max(0, (wrong.line - 4) * line_px);
  }, [jump]);
  return (
    <div class="editor">
      <div class="line-numbers" aria-hidden="true">
        <div ref={beside}>
          {wrong && <span style={{ top: `${(wrong.line - 1) * line_px}px` }} />}
          <pre>{lineNumbers(text)}</pre>
        </div>
      </div>
      <textarea
        ref={area}
        aria-label={label}
        aria-invalid={wrong !== null}
        aria-describedby={wrong ? 'editor-error' : undefined}
        wrap="off"
        spellcheck={false}
        autocomplete="off"
        value={text}
        onInput={({ currentTarget }) => type(currentTarget.value)}
        onScroll={scroll}
      />
    </div>
  );
}
