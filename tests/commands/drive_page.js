// Moves the slider of a page of scenes and says what changed; errors are kept from the start on.
const wrong = [], see = what => wrong.push(String(what));
addEventListener("error", e => see(e.message));
addEventListener("unhandledrejection", e => see(e.reason));
addEventListener("securitypolicyviolation", e => see(e.blockedURI));
console.error = see;

const wait = ms => new Promise(resolve => setTimeout(resolve, ms));

async function views() {
  return {
    cursor: maps.filter(map => map.cursor).map(map => map.line.offsetLeft),
    frames: maps.filter(map => map.times).map(map => JSON.stringify(map.box.data[0].z)),
    clock: [at("clock").textContent],
    traces: at("space").data.map(one => JSON.stringify(one.x)),
    picture: [await Plotly.toImage("space", {width: 400, height: 400})],
  };
}

async function drive() {
  await drawn;
  const before = await views(), moved = {};
  at("time").value = 8;
  at("time").dispatchEvent(new Event("input"));
  await wait(1000);
  const after = await views();
  for (const key in before) moved[key] = before[key].map((one, i) => one !== after[key][i]);
  const visible = () => maps[1].box.data.filter(one => one.visible === true).length, hidden = visible();
  at("truth").click();
  await wait(500);
  const curves = visible() - hidden;
  await choose(1);
  const headings = maps.map(map => map.box.querySelector(".gtitle").textContent);
  return {moved, curves, headings, title: document.title, images: document.images.length};
}

addEventListener("load", async () => {
  const found = await drive().catch(see), result = document.createElement("pre");
  result.id = "found";
  result.textContent = JSON.stringify({...found, wrong});
  document.body.append(result);
});
