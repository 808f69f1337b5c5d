import { defineConfig } from "vite";

// The package as it stands in this tree; cmake/ViewerPage.cmake keeps the place.
const client = decodeURIComponent(new URL("../../../../clients/javascript/src", import.meta.url).pathname);

export default defineConfig({
  resolve: { alias: { "softfinger-client": `${client}/browser.js` } },
  build: {
    target: "es2022",
    assetsInlineLimit: 0, // the page's content security policy allows no data: fonts
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1500,
    rollupOptions: { input: ["index.html", "study.html"] },
  },
  // `npm run dev -- --port 5173` beside a running program: the program only answers its own origin.
  server: {
    fs: { allow: [".", client] },
    proxy: {
      "/ws": { target: "ws://127.0.0.1:8080", ws: true, changeOrigin: true, rewriteWsOrigin: true },
    },
  },
});
