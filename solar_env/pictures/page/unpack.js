"use strict";
async function unpack(id) {
  const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
}
const ready = (async () => {
  document.getElementById("data").textContent = await unpack("data");
  for (const id of ["library", "program"]) {
    const script = document.createElement("script");
    script.textContent = await unpack(id);
    document.body.append(script);
  }
})();
ready.catch((error) => {
  document.getElementById("charts").textContent = `Motions and charts need a browser of 2023 or later (${error.message}).`;
});
