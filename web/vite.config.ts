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

export default defineConfig({
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact' },
  build: {
    target: 'es2020',
    outDir: 'dist',
    chunkSizeWarningLimit: 4000,
    lib: { entry: 'src/main.tsx', formats: ['iife'], name: 'robomillReport', fileName: () => 'page.js' },
  },
  plugins: [safeInScriptElement()],
  test: { include: ['src/**/*.test.{ts,tsx}'] },
});
