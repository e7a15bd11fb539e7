// The page: post a model, follow the job, show what came back. The contract is /openapi.json; nothing else is known here.

const $ = (id) => document.getElementById(id);
const form = $("form"), job = $("job");
let files = [];
let current = null; // the address of the job that is shown

// ---- Options: one field for each option of the contract.

async function buildOptions() {
  const contract = await (await fetch("/openapi.json")).json();
  const schemas = contract.components.schemas.Options.properties;
  const texts = {jpeg_quality: "JPEG quality"};
  for (const [name, schema] of Object.entries(schemas)) {
    const label = document.createElement("label");
    const plain = name.replaceAll("_", " ");
    label.textContent = texts[name] ?? plain[0].toUpperCase() + plain.slice(1);
    const field = document.createElement(schema.enum ? "select" : "input");
    field.name = name;
    for (const value of schema.enum ?? []) field.append(new Option(value, value));
    if (!schema.enum) {
      field.type = "number";
      field.step = schema.type === "integer" ? 1 : "any";
      field.min = schema.minimum ?? schema.exclusiveMinimum;
      field.max = schema.maximum ?? schema.exclusiveMaximum;
    }
    field.value = schema.default;
    field.dataset.fallback = schema.default;
    label.append(field);
    $("options").append(label);
  }
}

function chosenOptions() {
  const options = {};
  for (const field of $("options").querySelectorAll("input, select")) {
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

function modelOf(list) {
  const named = list.find((file) => /\.(glb|gltf|drc|obj|ply|stl|zip)$/i.test(file.name));
  return named ?? list[0];
}

async function start() {
  const body = new FormData();
  const model = modelOf(files);
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
    for await (const {id, event, data} of eventsOf(stream)) {
      last = id;
      state = event === "state" ? data : {...state, progress: data};
      show(state);
    }
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
  for (const id of ["download", "report", "facts", "timings"]) $(id).hidden = true;
  for (const figure of job.querySelectorAll("figure")) figure.hidden = true;
  $("errors").replaceChildren();
  $("detail").textContent = "";
  job.classList.remove("failed");
  job.hidden = false;
}

function show(state) {
  const words = {queued: "Waiting", running: "Working", succeeded: "Done", failed: "Failed", canceled: "Canceled", expired: "Expired"};
  $("state").textContent = words[state.state];
  $("progress").value = state.progress?.percent ?? 0;
  if (state.problem) return showProblem(state.problem);
  if (state.queue_position) $("detail").textContent = `Place ${state.queue_position} in the queue`;
  if (state.progress && state.state === "running") {
    const {stage, stage_index, stages, done, total, eta_ms} = state.progress;
    const toGo = eta_ms ? `, about ${milliseconds(eta_ms.p50)} to go` : "";
    $("detail").textContent = `Stage ${stage_index} of ${stages}: ${stage}, ${done.toLocaleString()} of ${total.toLocaleString()}${toGo}`;
  }
}

function showProblem(problem) {
  job.classList.add("failed");
  $("state").textContent = problem.title;
  $("detail").textContent = problem.detail;
  const items = (problem.errors ?? []).map((error) => {
    const item = document.createElement("li");
    const where = document.createElement("code");
    where.textContent = error.pointer;
    item.append(where, ` ${error.detail}`);
    return item;
  });
  $("errors").replaceChildren(...items);
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

// Keys travel in a header, so files are fetched and shown from memory.
async function objectUrl(address) {
  return URL.createObjectURL(await (await request(address)).blob());
}

async function showResult(state) {
  const report = await (await request(state.links.report)).json();
  const triangles = `${report.input.triangles.toLocaleString()} triangles`;
  $("detail").textContent = state.cached ? `${triangles}, known from before` : `${triangles} in ${milliseconds(state.timing.wall_ms)}`;
  $("download").href = await objectUrl(state.links.result);
  $("download").download = modelOf(files).name.replace(/\.[^.]*$/, "") + "-orbis.glb";
  $("report").href = URL.createObjectURL(new Blob([JSON.stringify(report, null, 2)], {type: "application/json"}));
  $("download").hidden = $("report").hidden = false;
  for (const [id, link] of [["preview", "preview.png"], ["atlas", "atlas.png"]]) {
    $(id).src = await objectUrl(state.links[link]);
    $(id).closest("figure").hidden = false;
  }
  const {certificate, distortion} = report;
  fillTable($("facts"), [
    ["Certificate", certificate.valid ? "valid" : "not valid"],
    ["Folded triangles", certificate.folded.toLocaleString()],
    ["Degree of the map", certificate.degree.toFixed(9)],
    ["Angles: quasi-conformal distortion, mean (1 is best)", distortion.quasi_conformal_mean?.toFixed(3) ?? "–"],
    ["Lengths: symmetric Dirichlet energy (1 is best)", distortion.symmetric_dirichlet?.toFixed(3) ?? "–"],
    ["Atlas", `${report.atlas.pages.map((page) => `${page.width} × ${page.height}`).join(", ")}, ${(100 * report.atlas.utilisation).toFixed(0)} % used`],
  ]);
  // The report's times are of the run that made the result, which a cached job did not have.
  const stages = report.timing.stages.map((s) => [s.name, milliseconds(s.wall_ms), milliseconds(s.cpu_ms)]);
  fillTable($("timings"), [...stages, ["in all", milliseconds(report.timing.wall_ms), milliseconds(report.timing.cpu_ms)]]);
}

// ---- What the user does.

function choose(list) {
  files = [...list];
  $("chosen").textContent = files.map((file) => file.name).join(", ");
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
  if (files.length === 0) return $("files").focus();
  const submit = form.querySelector("[type=submit]");
  submit.disabled = true;
  clear();
  $("state").textContent = "Sending";
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
