import { defineConfig } from "vite";

export default defineConfig({
  build: {
    target: "es2022",
    assetsInlineLimit: 0, // the page's content security policy allows no data: fonts
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1500,
  },
  // `npm run dev -- --port 5173` beside a running program: the program only answers its own origin.
  server: {
    proxy: {
      "/ws": { target: "ws://127.0.0.1:8080", ws: true, changeOrigin: true, rewriteWsOrigin: true },
    },
  },
});
