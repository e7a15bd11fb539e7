// Checkpoints of the embedding of all components: the ones that are done, and how far the one is that is being worked
// on.
#pragma once

#include <vector>

#include "core/checkpoints.h"
#include "core/sphere/embedding.h"
#include "core/steps/surface.h"

namespace orbis {

struct EmbeddedComponents {
  explicit EmbeddedComponents(const Surface& surface)
      : points(surface.mesh.positions.size()), embeddings(surface.components.size()),
        minimum(surface.components.size(), 0), done(surface.components.size(), 0) {}

  std::vector<Vec3d> points;                 // of the whole surface
  std::vector<sphere::Embedding> embeddings; // without their points
  std::vector<double> minimum;               // Eq. 3
  std::vector<std::uint8_t> done;            // by component
};

class ComponentCheckpoints {
public:
  // Puts what an interrupted run had done into `state`, which is what keep() keeps. All are kept by reference.
  ComponentCheckpoints(Checkpoints& inner, const Surface& surface, EmbeddedComponents& state);

  // For the embedding of one component.
  class OfOne final : public Checkpoints {
  public:
    OfOne(ComponentCheckpoints& all, std::uint32_t component) : all_(all), component_(component) {}
    [[nodiscard]] bool due() const override { return all_.inner_.due(); }
    void keep(std::span<const std::byte> state) override { all_.keep(component_, state); }
    [[nodiscard]] std::span<const std::byte> kept() const override;

  private:
    ComponentCheckpoints& all_;
    std::uint32_t component_;
  };

  // After a component is done.
  void keep_if_due();

private:
  void keep(std::uint32_t begun, std::span<const std::byte> its_state);
  void take_up();

  Checkpoints& inner_;
  const Surface& surface_;
  EmbeddedComponents& state_;
  std::uint32_t begun_;                    // a component, or one past the last
  std::span<const std::byte> begun_state_; // in inner_.kept()
};

} // namespace orbis
