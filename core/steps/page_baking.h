// The page of the atlas that is being baked: what its maps are made from, and where they go.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/steps/bake_maps.h"
#include "core/steps/corner_values.h"
#include "core/steps/encode_map.h"
#include "core/steps/material_sources.h"
#include "core/steps/mesh_by_page.h"
#include "core/texture/texel_map.h"
#include "core/texture/texture_reader.h"

namespace orbis {

// What bake_maps() was called with.
struct BakeJob {
  const Request& request;
  const Limits& limits;
  const asset::Asset& asset; // what the texels show
  const Surface& surface;
  const texture::CutMesh& cut;
  SurfaceInAtlas shown; // what is delivered: the same but for a remesh
  Delivery& delivery;
  std::span<DetailLevel> levels;
  Progress& progress;
  Report& report;

  [[nodiscard]] const Options& options() const { return request.options; }
  // Whether a map of the materials' own is baked where there is something to bake it from.
  [[nodiscard]] bool wants(Map map) const { return options().maps.automatic || options().maps.names(map); }
};

[[nodiscard]] bool any(const SlotTextures& textures);
[[nodiscard]] bool any(const std::vector<bool>& flags);

class PageBaking {
public:
  // Keeps a reference to the job. No page is open yet.
  explicit PageBaking(const BakeJob& job);

  // Goes to a page and finds out what its texels show.
  void open(std::uint32_t page);

  [[nodiscard]] std::uint32_t page() const { return page_; }
  [[nodiscard]] const texture::TexelMap& map() const { return *map_; }
  // The same page by the triangles that are delivered.
  [[nodiscard]] const texture::TexelMap& delivered_map() const { return delivered_map_ ? *delivered_map_ : *map_; }
  [[nodiscard]] texture::PageMesh mesh() const { return by_page_.mesh(page_); }
  // The charts of the page.
  [[nodiscard]] std::span<const std::uint32_t> charts() const { return by_page_.charts(page_); }
  [[nodiscard]] CornerValues& values() { return values_; }
  [[nodiscard]] ImageDecoder& images() { return images_; }
  [[nodiscard]] std::span<const std::uint32_t> primitive_of() const { return primitive_of_; }
  [[nodiscard]] mesh::ThreadPool& pool() { return pool_; }

  // Whether a primitive of the asset is shown on the page; and the textures of those that are.
  [[nodiscard]] bool shows(std::size_t primitive) const;
  [[nodiscard]] SlotTextures shown(const SlotTextures& textures) const;
  // The coordinates through which the textures are read, by delivered triangle.
  [[nodiscard]] std::span<const texture::CornerUv> source_uv(const SlotTextures& textures);

  // Every map becomes a file and an entry of the report; what materials show becomes an image of the result too, whose
  // number is returned. name: "normal"; with several pages it becomes "normal-2".
  template <class Picture>
  std::uint32_t add(const Picture& image, MapKind kind, const std::string& name, bool shown = true) {
    return add(encode_map(image, kind, named(name), job_.options()), image.width, image.height,
               8 * sizeof(typename decltype(image.pixels)::value_type), shown);
  }
  // For facts about the map that was added last.
  [[nodiscard]] Report::BakedMap& last_map() { return job_.report.maps.back(); }

  // The base colour of the page, for pictures.
  void keep_base_color(texture::Image image) { out_.pages.push_back(std::move(image)); }
  [[nodiscard]] BakedMaps take() { return std::move(out_); }

private:
  [[nodiscard]] std::string named(const std::string& map) const;
  std::uint32_t add(asset::NewImage image, std::uint32_t width, std::uint32_t height, std::size_t bits, bool shown);

  const BakeJob& job_;
  mesh::ThreadPool pool_;
  CornerValues values_;
  ImageDecoder images_;
  std::vector<std::uint32_t> primitive_of_; // by delivered triangle
  MeshByPage by_page_;
  std::optional<MeshByPage> delivered_by_page_; // where these triangles are others
  std::uint32_t page_ = 0;
  std::optional<texture::TexelMap> map_, delivered_map_;
  BakedMaps out_;
};

} // namespace orbis
