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
// The words of the address, of which some name files beside the page.
const asked = decodeURIComponent(location.search.slice(1).replaceAll("+", " ")).split(" ");
// A frame in another page leaves the wheel and the finger to it until it is clicked.
const embedded = asked.includes("embed=1");

// Keys of the browser, which the program must not see: it would keep the browser from them.
addEventListener("keydown", (event) => {
  const withControl = event.ctrlKey || event.metaKey;
  const undoes = withControl && /^[zy]$/i.test(event.key);
  if ((withControl && !undoes) || event.altKey || /^F([5-9]|12)$/.test(event.key)) event.stopImmediatePropagation();
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

// Fetches the scenes that the address names, and the meshes that these name.
const fetchScenes = async (program) => {
  const fetchFile = async (name) => {
    const place = new URL(name, location);
    const response = place.origin === location.origin && await fetch(place);
    if (!response?.ok) throw new Error(`there is no file ${name} beside this page`);
    program.keep_file(name, new Uint8Array(await response.clone().arrayBuffer()));
    return response;
  };
  const isFile = (word) => /\.(toml|json)$/i.test(word);
  const words = asked.flatMap((word) => word.replace(/^scenes=/, "").split(",")).filter(isFile);
  for (const name of new Set(words)) {
    const text = await (await fetchFile(name)).text();
    for (const [, mesh] of text.matchAll(/\bfile\b"?\s*[=:]\s*["']([^"']+)["']/g)) {
      await fetchFile(name.replace(/[^/]*$/, "") + mesh);
    }
  }
};

if (embedded) {
  document.body.classList.add("embedded");
  addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) event.stopImmediatePropagation();
  }, true);
}

try {
  // A browser may support WebGPU without having an adapter for it.
  const adapter = relaxed && await navigator.gpu?.requestAdapter().catch(() => null);
  const build = adapter ? "webgpu" : relaxed ? "webgl" : "plain";
  if (!adapter && !document.createElement("canvas").getContext("webgl2")) {
    throw new Error("a3 draws with WebGPU or WebGL 2, and this browser has neither, or not here: try another browser");
  }
  const program = await import(`./${build}/a3_web.js`);
  await program.default();
  await fetchScenes(program);
  program.start();
  if (words.textContent.startsWith("a3 is loading")) words.textContent = "";
  if (!embedded) canvas.focus();
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    open(program, [...event.dataTransfer.items]);
  });
} catch (error) {
  console.error(error);
  words.textContent = error.message;
}
