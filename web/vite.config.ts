import { defineConfig, type Plugin } from 'vite';

/** The script stands inside a script element: it must not contain what would end that element. */
function safeInScriptElement(): Plugin {
  return {
    name: 'safe-in-script-element',
    generateBundle(_options, bundle) {
      for (const chunk of Object.values(bundle)) {
        if (chunk.type !== 'chunk') this.error(`${chunk.fileName}: everything must be in the one script`);
        else if (/<\/script|<!--/i.test(chunk.code)) this.error(`${chunk.fileName}: would end its script element`);
      }
    },
  };
}

/** Two scripts: the page, and with `--mode path` what draws a path in three dimensions, for reports that have one. */
const scripts = {
  page: { entry: 'src/main.tsx', name: 'robomillReport' },
  path: { entry: 'src/path/main.ts', name: 'robomillPathScript' },
};

export default defineConfig(({ mode }) => ({
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact' },
  build: {
    target: 'es2020',
    outDir: mode === 'path' ? 'dist-path' : 'dist',
    chunkSizeWarningLimit: 4000,
    lib: { ...scripts[mode === 'path' ? 'path' : 'page'], formats: ['iife'], fileName: () => (mode === 'path' ? 'page-path.js' : 'page.js') },
  },
  plugins: [safeInScriptElement()],
  test: { include: ['src/**/*.test.{ts,tsx}'] },
}));
