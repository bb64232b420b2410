import {defineConfig} from 'vite';

export default defineConfig({
  base: './',
  build: {chunkSizeWarningLimit: 1000, target: 'es2022'},
  test: {environment: 'node'},
} as Parameters<typeof defineConfig>[0]);
