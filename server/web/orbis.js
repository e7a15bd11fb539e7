// The page: post a model, follow the job, show what came back. The options are those of the contract, /openapi.json.

const $ = (id) => document.getElementById(id);
const form = $("form"), job = $("job");
let files = [];
let current = null; // the address of the job that is shown

// ---- Options: one field for each option of the contract, those that are asked for most in front.

const foremost = ["objective", "quality", "texture", "texture_size"];

// What is to be written into the fields that offer no choice.
const hints = {
  maps: "auto, all, or names with commas between them: base_color, metallic_roughness, occlusion, emissive, normal, object_normal, ambient_occlusion, position, displacement",
  lods: "Parts of the triangles, their numbers, or deviation:0.1 in per cent of the diagonal, with commas between them: 0.25,0.05,0.01",
  remesh: "none, octahedral:N or icosahedral:N, with N from 1 to 8",
  morph_to: "The file name of a second model, chosen along with the first: horse.glb",
  features: "With a second model: pairs of points, the first model's and then the second's: [[[0,0,1],[0,0,2]]]",
};

function fieldFor(name, schema) {
  const choices = schema.type === "boolean" ? ["false", "true"] : schema.enum;
  const field = document.createElement(choices ? "select" : "input");
  field.name = name;
  field.title = schema.description ?? "";
  for (const value of choices ?? []) field.append(new Option(value === "false" ? "no" : value === "true" ? "yes" : value, value));
  if (!choices && schema.type === "string") {
    field.placeholder = schema.examples ? `none; such as ${schema.examples[0]}` : "";
    field.spellcheck = false;
  } else if (!choices) {
    field.type = "number";
    field.step = schema.type === "integer" ? 1 : "any";
    field.min = schema.minimum ?? schema.exclusiveMinimum ?? "";
    field.max = schema.maximum ?? schema.exclusiveMaximum ?? "";
  }
  field.value = schema.default;
  field.dataset.fallback = schema.default;
  return field;
}

// A field under its name, and where it is free text its format below.
function labelled(name, field) {
  const texts = {jpeg_quality: "JPEG quality", lods: "Levels of detail", maps: "Maps to bake"};
  const label = document.createElement("label");
  const plain = name.replaceAll("_", " ");
  label.textContent = texts[name] ?? plain[0].toUpperCase() + plain.slice(1);
  label.append(field);
  if (!hints[name]) return label;
  const box = document.createElement("div"), hint = document.createElement("small");
  hint.id = `hint-${name}`;
  hint.textContent = hints[name];
  field.setAttribute("aria-describedby", hint.id);
  box.append(label, hint);
  return box;
}

async function buildOptions() {
  const contract = await (await fetch("/openapi.json")).json();
  const schemas = contract.components.schemas.Options.properties;
  for (const [name, schema] of Object.entries(schemas)) {
    const place = foremost.includes(name) ? "options" : hints[name] ? "written-options" : "more-options";
    $(place).append(labelled(name, fieldFor(name, schema)));
  }
}

function chosenOptions() {
  const options = {};
  for (const field of form.querySelectorAll("fieldset input, fieldset select")) {
    if (field.value !== field.dataset.fallback) options[field.name] = field.value;
  }
  return options;
}

// ---- Requests.

function headers() {
  return $("key").value ? {Authorization: `Bearer ${$("key").value}`} : {};
}

// The answer's JSON; throws the problem document where there is one.
async function request(address, init = {}) {
  const response = await fetch(address, {...init, headers: {...headers(), ...init.headers}});
  if (response.ok) return response;
  if (response.status === 401 || response.status === 403) $("key-row").hidden = false;
  const problem = await response.json().catch(() => ({title: "The service does not answer", detail: `Status ${response.status}`}));
  throw problem;
}

const modelsIn = (list) => list.filter((file) => /\.(glb|gltf|drc|obj|ply|stl|zip)$/i.test(file.name));

const modelOf = (list) => modelsIn(list)[0] ?? list[0];

async function start() {
  const body = new FormData();
  const model = modelOf(files), models = modelsIn(files).map((file) => file.name);
  if (models.length > 1 && !chosenOptions().morph_to)
    throw {title: "One model at a time", detail: `${models.join(" and ")} are models of their own; what goes along are the files that a model names`};
  body.append("model", model, model.name);
  for (const file of files) if (file !== model) body.append("file", file, file.name);
  body.append("options", JSON.stringify(chosenOptions()));
  const created = await (await request("/v1/jobs", {method: "POST", body})).json();
  current = created.links.self;
  await follow(created);
}

// The events of a stream, one after the other: {id, event, data}. An EventSource could send no key.
async function* eventsOf(response) {
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const {value, done} = await reader.read();
    if (done) return;
    text += value;
    const parts = text.split("\n\n");
    text = parts.pop();
    for (const part of parts) {
      const fields = Object.fromEntries(part.split("\n").map((line) => line.split(/: ?(.*)/s)));
      if (fields.data) yield {id: fields.id, event: fields.event, data: JSON.parse(fields.data)};
    }
  }
}

const isOver = (state) => state !== "queued" && state !== "running";

// Shows what the job's events say until it is over; a stream that breaks off is taken up where it ended.
async function follow(state) {
  $("cancel").disabled = false;
  show(state);
  let last = "";
  while (!isOver(state.state)) {
    const stream = await request(state.links.events, {headers: last ? {"Last-Event-ID": last} : {}});
    let heard = false;
    for await (const {id, event, data} of eventsOf(stream)) {
      heard = true;
      last = id;
      state = event === "state" ? data : {...state, progress: data};
      show(state);
    }
    if (!heard) await new Promise((resolve) => setTimeout(resolve, 1000)); // the service may be going down
    // Whatever happened meanwhile, and whether the service is still there.
    state = await (await request(state.links.self)).json();
    show(state);
  }
  $("cancel").disabled = true;
  if (state.state === "succeeded") await showResult(state);
}

// ---- What is seen.

const milliseconds = (ms) => ms == null ? "–" : ms < 1000 ? `${ms.toFixed(0)} ms` : `${(ms / 1000).toFixed(2)} s`;

function clear() {
  for (const id of ["download", "report", "facts", "levels", "timings", "maps", "notes"]) $(id).hidden = true;
  $("progress").hidden = false;
  for (const figure of job.querySelectorAll("figure")) figure.hidden = true;
  $("errors").replaceChildren();
  $("detail").textContent = "";
  job.classList.remove("failed");
  job.hidden = false;
}

// The options, opened, may have taken the whole window.
const bringIntoView = () => job.scrollIntoView();

function show(state) {
  const words = {queued: "Waiting", running: "Working", succeeded: "Done", failed: "Failed", canceled: "Canceled", expired: "Expired"};
  $("state").textContent = words[state.state];
  // What was known from before is done without ever having been under way.
  $("progress").value = state.state === "succeeded" ? 100 : state.progress?.percent ?? 0;
  if (state.problem) return showProblem(state.problem);
  $("detail").textContent = "";
  if (state.queue_position) $("detail").textContent = `Place ${state.queue_position} in the queue`;
  if (state.progress && state.state === "running") {
    const {stage, stage_index, stages, done, total, eta_ms} = state.progress;
    const toGo = eta_ms ? `, about ${milliseconds(eta_ms.p50)} to go` : "";
    $("detail").textContent = `Stage ${stage_index} of ${stages}: ${stage}, ${done.toLocaleString()} of ${total.toLocaleString()}${toGo}`;
  }
}

function showProblem(problem) {
  job.classList.add("failed");
  $("progress").hidden = true;
  $("state").textContent = problem.title;
  $("detail").textContent = problem.detail;
  // One error that says what the detail says adds nothing but its place.
  $("errors").replaceChildren(...(problem.errors ?? []).map(({pointer, detail}) =>
    listItem(pointer, detail === problem.detail ? "" : detail)));
  bringIntoView();
}

// A place in the document, where there is one, and what is said of it.
function listItem(where, text) {
  const item = document.createElement("li");
  item.append(text);
  if (where) {
    const place = document.createElement("code");
    place.textContent = where;
    item.append(text ? " " : "at ", place);
  }
  return item;
}

// What was repaired, what could not be kept, and what could not be unfolded: then the job is not whole.
function showNotes({notes, partial, components}) {
  if (partial) $("state").textContent = "Done in part";
  const problems = components.filter(({problem}) => problem).map(({problem}) => listItem(problem.where, `Not unfolded: ${problem.message}`));
  const items = [...problems, ...notes.map(({message, where}) => listItem(where, message))];
  $("notes").querySelector("ul").replaceChildren(...items);
  $("notes").hidden = items.length === 0;
}

// A link to each baked map; the first click fetches it, with the key.
function showMaps(state, maps) {
  const links = maps.map(({name}) => {
    const link = document.createElement("a");
    link.textContent = link.download = name;
    link.href = `${state.links.self}/maps/${encodeURIComponent(name)}`;
    link.addEventListener("click", async (event) => {
      if (link.href.startsWith("blob:")) return;
      event.preventDefault();
      link.href = await objectUrl(link.href);
      link.click();
    });
    return link;
  });
  $("maps").replaceChildren("Maps: ", ...links.flatMap((link, i) => i === 0 ? [link] : [" · ", link]));
  $("maps").hidden = links.length === 0;
}

function fillTable(table, rows) {
  table.tBodies[0].replaceChildren(...rows.map((cells) => {
    const row = document.createElement("tr");
    cells.forEach((text, i) => {
      const cell = document.createElement(i === 0 ? "th" : "td");
      if (i === 0) cell.scope = "row";
      cell.textContent = text;
      row.append(cell);
    });
    return row;
  }));
  table.hidden = false;
}

function showLevels({levels, output}) {
  if (levels.length === 0) return;
  fillTable($("levels"), [
    ["full model", output.triangles.toLocaleString(), "–", "–"],
    ...levels.map(({target, triangles, mean_distance, psnr}) =>
      [target.replace(":", " "), triangles.toLocaleString(), mean_distance?.toFixed(3) ?? "–", psnr?.toFixed(1) ?? "–"]),
  ]);
}

// Keys travel in a header, so files are fetched and shown from memory.
async function objectUrl(address) {
  return URL.createObjectURL(await (await request(address)).blob());
}

async function showResult(state) {
  const report = await (await request(state.links.report)).json();
  const triangles = `${report.input.triangles.toLocaleString()} triangles`;
  $("detail").textContent = state.cached ? `${triangles}, known from before` : `${triangles} in ${milliseconds(state.timing.wall_ms)}`;
  $("download").href = await objectUrl(state.links.result);
  $("download").download = modelOf(files).name.replace(/\.[^.]*$/, "") + `-orbis.${state.options.output}`;
  $("report").href = URL.createObjectURL(new Blob([JSON.stringify(report, null, 2)], {type: "application/json"}));
  $("download").textContent = state.options.output === "zip" ? "Download the zip" : "Download the GLB";
  $("download").hidden = $("report").hidden = false;
  for (const [id, link] of [["preview", "preview.png"], ["atlas", "atlas.png"]]) {
    $(id).src = await objectUrl(state.links[link]);
    $(id).closest("figure").hidden = false;
  }
  showMaps(state, report.maps);
  showNotes(report);
  showLevels(report);
  const {certificate, distortion} = report;
  fillTable($("facts"), [
    ["Components", report.topology.components.toLocaleString()],
    ["Triangles delivered, cut at the atlas' borders", report.output.triangles.toLocaleString()],
    ["Certificate", certificate.valid ? "valid" : "not valid"],
    ["Folded triangles", certificate.folded.toLocaleString()],
    ["Degree of the map", Number(certificate.degree.toFixed(6)).toLocaleString()],
    ["Angles: quasi-conformal distortion, mean (1 is best)", distortion.quasi_conformal_mean?.toFixed(3) ?? "–"],
    ["Lengths: symmetric Dirichlet energy (1 is best)", distortion.symmetric_dirichlet?.toFixed(3) ?? "–"],
    ["Atlas", `${report.atlas.pages.map((page) => `${page.width} × ${page.height}`).join(", ")}, ${(100 * report.atlas.utilisation).toFixed(0)} % used`],
  ]);
  // The report's times are of the run that made the result, which a cached job did not have.
  const stages = report.timing.stages.map((s) => [s.name, milliseconds(s.wall_ms), milliseconds(s.cpu_ms)]);
  fillTable($("timings"), [...stages, ["in all", milliseconds(report.timing.wall_ms), milliseconds(report.timing.cpu_ms)]]);
  bringIntoView();
}

// ---- What the user does.

function choose(list) {
  files = [...list];
  $("no-model").hidden = true;
  // The field itself names what was chosen, and is told what was dropped.
  if ($("files").files !== list) $("files").files = list;
}

$("files").addEventListener("change", (event) => choose(event.target.files));
$("drop").addEventListener("dragover", (event) => { event.preventDefault(); $("drop").classList.add("over"); });
$("drop").addEventListener("dragleave", () => $("drop").classList.remove("over"));
$("drop").addEventListener("drop", (event) => {
  event.preventDefault();
  $("drop").classList.remove("over");
  choose(event.dataTransfer.files);
});

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  if (files.length === 0) {
    $("no-model").hidden = false;
    return $("files").focus();
  }
  const submit = form.querySelector("[type=submit]");
  submit.disabled = true;
  clear();
  $("state").textContent = "Sending";
  bringIntoView();
  try {
    await start();
  } catch (problem) {
    showProblem(problem instanceof Error ? {title: "The service does not answer", detail: "Is it still running?"} : problem);
  }
  submit.disabled = false;
  $("cancel").disabled = true;
});

$("cancel").addEventListener("click", () => request(current, {method: "DELETE"}).catch(showProblem));

buildOptions();
