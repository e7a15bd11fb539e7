#include "core/steps/page_baking.h"

#include <algorithm>

namespace orbis {
namespace {

constexpr std::size_t kept_images = 1U << 27U; // bytes: two of 4096 x 4096 texels, for the pages behind the first

} // namespace

bool any(const SlotTextures& textures) {
  return std::ranges::any_of(textures, [](const auto& t) { return t.has_value(); });
}
bool any(const std::vector<bool>& flags) { return std::ranges::find(flags, true) != flags.end(); }

PageBaking::PageBaking(const BakeJob& job)
    : job_(job), pool_(job.options().threads), values_(job.asset, job.surface, job.cut, pool_),
      images_(job.asset, job.limits, job.report, job.cut.pages.size() > 1 ? kept_images : 0), by_page_(job.cut) {
  primitive_of_.reserve(job.cut.triangles.size());
  for (std::size_t t = 0; t < job.cut.triangles.size(); ++t) primitive_of_.push_back(values_.primitive(t));
  if (&job.shown.cut != &job.cut) delivered_by_page_.emplace(job.shown.cut);
}

void PageBaking::open(std::uint32_t page) {
  page_ = page;
  values_.show(by_page_.triangles(page));
  map_.emplace(by_page_.map(page, pool_));
  if (delivered_by_page_) delivered_map_.emplace(delivered_by_page_->map(page, pool_));
}

bool PageBaking::shows(std::size_t primitive) const {
  return !job_.delivery.primitives[primitive].indices.empty() && job_.delivery.page_of[primitive] == page_;
}

SlotTextures PageBaking::shown(const SlotTextures& textures) const {
  SlotTextures out(textures.size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    if (shows(p)) out[p] = textures[p];
  }
  return out;
}

std::span<const texture::CornerUv> PageBaking::source_uv(const SlotTextures& textures) {
  std::vector<const asset::Attribute*> uv_of(textures.size());
  for (std::size_t p = 0; p < textures.size(); ++p) {
    if (textures[p]) uv_of[p] = job_.asset.primitives[p].find(textures[p]->uv);
  }
  return values_.uv(uv_of);
}

std::string PageBaking::named(const std::string& map) const {
  return job_.cut.pages.size() > 1 ? map + '-' + std::to_string(page_ + 1) : map;
}

std::uint32_t PageBaking::add(asset::NewImage image, std::uint32_t width, std::uint32_t height, std::size_t bits,
                              bool shown) {
  const std::string file = image.name + "." + ending_of(image);
  job_.report.maps.push_back({file, page_, width, height, static_cast<std::uint32_t>(bits), image.bytes.size(), {}});
  out_.files.push_back({file, image.bytes});
  if (!shown) return 0;
  out_.images.push_back(std::move(image));
  return static_cast<std::uint32_t>(out_.images.size() - 1);
}

} // namespace orbis
