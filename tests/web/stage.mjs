// Headless Chromium with the page that draws models, and a small file server for it.
import fs from 'node:fs'
import http from 'node:http'
import path from 'node:path'
import {chromium} from 'playwright-core'

const types = {html: 'text/html', js: 'text/javascript', wasm: 'application/wasm', glb: 'model/gltf-binary', gltf: 'model/gltf+json', png: 'image/png'}

export class Stage {
  // `three`: the package's directory; `page`: where page.html and render.js lie.
  static async open({three, page}) {
    const stage = new Stage()
    stage.roots = {three}
    stage.server = http.createServer((request, response) => stage.#answer(request, response, page))
    await new Promise((resolve) => stage.server.listen(0, '127.0.0.1', resolve))
    stage.address = `http://127.0.0.1:${stage.server.address().port}`
    stage.browser = await chromium.launch({
      executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
      args: ['--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    })
    return stage
  }

  // Draws both models from the same place: {covered, overlap, difference, picture (a PNG)}.
  async compare(input, output) {
    Object.assign(this.roots, {input: path.dirname(input), output: path.dirname(output)})
    const page = await this.browser.newPage()
    try {
      await page.goto(`${this.address}/page.html`)
      await page.waitForFunction('window.ready')
      const names = [`/input/${encodeURIComponent(path.basename(input))}`, `/output/${encodeURIComponent(path.basename(output))}`]
      const result = await page.evaluate(([a, b]) => window.compareModels(a, b), names)
      return {...result, picture: Buffer.from(result.picture.split(',')[1], 'base64')}
    } finally {
      await page.close()
    }
  }

  async close() {
    await this.browser.close()
    this.server.close()
  }

  #answer(request, response, page) {
    const [, first, ...rest] = decodeURIComponent(new URL(request.url, this.address).pathname).split('/')
    const file = rest.length > 0 ? path.join(this.roots[first] ?? page, ...rest) : path.join(page, first)
    if (!fs.existsSync(file) || !fs.statSync(file).isFile()) return response.writeHead(404).end()
    response.writeHead(200, {'Content-Type': types[path.extname(file).slice(1)] ?? 'application/octet-stream'})
    fs.createReadStream(file).pipe(response)
  }
}
