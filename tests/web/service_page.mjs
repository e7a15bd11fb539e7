// The service's own page in a browser: a model is chosen and sent, its progress followed, its result shown and downloaded.
import {spawn} from 'node:child_process'
import fs from 'node:fs'
import path from 'node:path'

// Starts `orbis serve` on a free port; resolves with its address and what stops it.
async function serve(orbis, data) {
  const child = spawn(orbis, ['serve', '--port', '0', '--data', data, '--workers', '1'], {stdio: ['ignore', 'ignore', 'pipe']})
  const address = await new Promise((resolve, reject) => {
    let log = ''
    child.stderr.on('data', (text) => {
      log += text
      const line = log.split('\n').find((part) => part.includes('"listening"'))
      if (line) resolve(JSON.parse(line).address)
    })
    child.on('exit', () => reject(new Error(`the service did not start: ${log}`)))
  })
  const stopped = new Promise((resolve) => child.on('exit', resolve))
  return {address, stop: () => { child.kill('SIGTERM'); return stopped }}
}

const expect = (holds, what) => { if (!holds) throw new Error(what) }

// Sends `files` through the page and returns what it shows in the end. `picture` is a screenshot of that.
async function send(page, files, picture) {
  await page.setInputFiles('#files', files)
  await page.click('button[type=submit]')
  // A selector, since the page's policy lets no script be evaluated, not even a test's.
  await page.waitForSelector('button[type=submit]:not([disabled])', {timeout: 300_000})
  await page.screenshot({path: picture, fullPage: true})
  return page.evaluate(() => ({
    state: document.querySelector('#state').textContent,
    detail: document.querySelector('#detail').textContent,
    failed: document.querySelector('#job').classList.contains('failed'),
    pictures: [...document.querySelectorAll('figure:not([hidden]) img')].map((image) => image.naturalWidth),
    progress: document.querySelector('#progress').value,
    facts: Object.fromEntries([...document.querySelectorAll('#facts tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))),
    levels: [...document.querySelectorAll('#levels:not([hidden]) tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent)),
    isInView: document.querySelector('#state').getBoundingClientRect().top >= 0 &&
      document.querySelector('#state').getBoundingClientRect().bottom <= window.innerHeight,
  }))
}

// `models`: a directory with crate.gltf and its files; `refused`: a model that no option makes right.
export async function testPage({orbis, browser, models, refused, scratch, out}, test) {
  const service = await serve(orbis, path.join(scratch, 'service'))
  const page = await browser.newPage({viewport: {width: 1100, height: 800}})
  const complaints = []
  page.on('console', (message) => { if (message.type() === 'error') complaints.push(message.text()) })
  page.on('pageerror', (error) => complaints.push(error.message))
  const crate = ['crate.gltf', 'crate.bin', 'crate colours.png'].map((name) => path.join(models, name))
  await page.goto(service.address)
  await page.waitForSelector('#options select')

  await test('the page asks for a model where there is none', async () => {
    await page.click('button[type=submit]')
    expect(await page.isVisible('#no-model') && !(await page.isVisible('#job')), 'it does not')
    await page.setInputFiles('#files', crate)
    expect(!(await page.isVisible('#no-model')), 'it still does when there is one')
  })
  await test('the page sends a model of several files, shows what came back, and gives it for download', async () => {
    const shown = await send(page, crate, path.join(out, 'page-done.png'))
    expect(shown.state === 'Done', `the page says '${shown.state}: ${shown.detail}'`)
    expect(shown.pictures.length === 2 && shown.pictures.every((width) => width > 0), 'a picture is missing')
    expect(Object.keys(shown.facts).length > 3, 'there are no facts')
    expect(shown.facts['Degree of the map'] === '1', `the degree is ${shown.facts['Degree of the map']}`)
    expect(shown.levels.length === 0, 'there are levels of detail that nobody asked for')
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#download')])
    expect(download.suggestedFilename() === 'crate-orbis.glb', `the file is called ${download.suggestedFilename()}`)
    const file = path.join(scratch, 'downloaded.glb')
    await download.saveAs(file)
    expect(fs.readFileSync(file).toString('latin1', 0, 4) === 'glTF', 'the download is no GLB')
  })
  await test('the page says that a result was there already', async () => {
    const shown = await send(page, crate, path.join(out, 'page-cached.png'))
    expect(/known from before/.test(shown.detail), `the page says '${shown.detail}'`)
    expect(shown.progress === 100, `the bar is at ${shown.progress}`)
  })
  await test('the page tells the format of what is written by hand', async () => {
    await page.click('summary')
    for (const name of ['maps', 'lods', 'remesh', 'morph_to', 'features'])
      expect((await page.textContent(`#hint-${name}`)).length > 20 && await page.isVisible(`#hint-${name}`), `there is no hint for ${name}`)
  })
  await test('the page lists the levels of detail, and brings them into view from below the options', async () => {
    await page.fill('[name=lods]', '0.5,0.25')
    const shown = await send(page, crate, path.join(out, 'page-levels.png'))
    await page.fill('[name=lods]', '')
    expect(shown.state === 'Done' && shown.isInView, `the page says '${shown.state}: ${shown.detail}', ${shown.isInView ? '' : 'not '}in view`)
    expect(shown.levels.length === 3 && shown.levels[1][0] === '0.5', `the levels are ${JSON.stringify(shown.levels)}`)
    expect(shown.levels[1][2] > 0 && shown.levels[1][3] > 0, `the first is ${shown.levels[1]}`)
  })
  await test('the page tells why a model was refused', async () => {
    const shown = await send(page, [refused], path.join(out, 'page-refused.png'))
    expect(shown.failed && shown.detail.length > 20, `the page says '${shown.state}: ${shown.detail}'`)
    expect(shown.pictures.length === 0, 'the pictures of the model before are still there')
    expect(shown.isInView, 'what it says is out of view')
  })
  await test('the page takes one model at a time, and says which there are', async () => {
    const shown = await send(page, [...crate, refused], path.join(out, 'page-two-models.png'))
    expect(shown.failed && /crate\.gltf/.test(shown.detail), `the page says '${shown.state}: ${shown.detail}'`)
  })
  await test('the browser has nothing to complain about', () => expect(complaints.length === 0, complaints.join('; ')))
  await page.close()
  await service.stop()
}
