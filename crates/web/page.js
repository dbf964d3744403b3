// Loads the program, and passes it the events that only a page receives.

// Fused multiplications are an instruction of relaxed SIMD, without which they are slow; a program
// of 30 bytes that uses it shows whether the browser supports it.
const relaxed = WebAssembly.validate(new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 15, 1, 13, 0, 65, 1, 253, 15, 65, 2, 253, 15,
  253, 128, 2, 11,
]));
const words = document.getElementById("words");
const canvas = document.getElementById("a3");
// The largest file that is opened (bytes).
const LARGEST = 64 << 20;

// Keys of the browser, which the program must not see: it would keep the browser from them.
addEventListener("keydown", (event) => {
  const withControl = event.ctrlKey || event.metaKey;
  const undoes = withControl && /^[zy]$/i.test(event.key);
  if ((withControl && !undoes) || event.altKey || /^F([3-9]|12)$/.test(event.key)) event.stopImmediatePropagation();
}, true);

// Opens files that were dropped, and says which of them it cannot open.
const open = async (program, items) => {
  const files = items.map((item) => [item.getAsFile(), item.webkitGetAsEntry?.()?.isDirectory]);
  // A scene comes after the meshes that it names.
  const last = ([file]) => /\.(toml|json)$/i.test(file.name);
  for (const [file, folder] of files.filter(([file]) => file).sort((a, b) => last(a) - last(b))) {
    if (folder) {
      program.say(`${file.name} is a folder: drop the scene file and the meshes in it.`);
    } else if (file.size > LARGEST) {
      program.say(`${file.name} has ${Math.ceil(file.size / (1 << 20))} MB, and a page opens at most 64 MB.`);
    } else {
      program.open_file(file.name, new Uint8Array(await file.arrayBuffer()));
    }
  }
};

try {
  // A browser may support WebGPU without having an adapter for it.
  const adapter = relaxed && await navigator.gpu?.requestAdapter().catch(() => null);
  const build = adapter ? "webgpu" : relaxed ? "webgl" : "plain";
  if (!adapter && !document.createElement("canvas").getContext("webgl2")) {
    throw new Error("a3 draws with WebGPU or WebGL 2, and this browser has neither, or not here: try another browser");
  }
  const program = await import(`./${build}/a3_web.js`);
  await program.default();
  program.start();
  if (words.textContent.startsWith("a3 is loading")) words.textContent = "";
  canvas.focus();
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    open(program, [...event.dataTransfer.items]);
  });
} catch (error) {
  console.error(error);
  words.textContent = error.message;
}
