#include "core/steps/component_checkpoints.h"

#include <type_traits>

namespace orbis {
namespace {

// The numbers of an embedding, without its points.
template <class Embedding, class Apply> void each_number(Embedding& e, Apply apply) {
  apply(e.t1_ms);
  apply(e.t2_ms);
  apply(e.t3_ms);
  apply(e.relaxations);
  apply(e.converged);
}

template <class T> std::span<T> part(std::vector<T>& points, const Component& component) {
  return std::span(points).subspan(component.first_vertex, component.vertices);
}

} // namespace

ComponentCheckpoints::ComponentCheckpoints(Checkpoints& inner, const Surface& surface, EmbeddedComponents& state)
    : inner_(inner), surface_(surface), state_(state), begun_(static_cast<std::uint32_t>(surface.components.size())) {
  if (!inner_.kept().empty()) take_up();
}

std::span<const std::byte> ComponentCheckpoints::OfOne::kept() const {
  return component_ == all_.begun_ ? all_.begun_state_ : std::span<const std::byte>();
}

void ComponentCheckpoints::keep_if_due() {
  if (inner_.due()) keep(static_cast<std::uint32_t>(surface_.components.size()), {});
}

void ComponentCheckpoints::keep(std::uint32_t begun, std::span<const std::byte> its_state) {
  StateWriter out;
  out.value(std::uint64_t{surface_.mesh.positions.size()});
  out.values(std::span<const std::uint8_t>(state_.done));
  for (std::size_t c = 0; c < state_.done.size(); ++c) {
    if (state_.done[c] == 0) continue;
    each_number(state_.embeddings[c], [&](const auto& number) { out.value(number); });
    out.value(state_.minimum[c]);
    out.values(std::span<const Vec3d>(part(state_.points, surface_.components[c])));
  }
  out.value(begun);
  out.value(std::uint64_t{its_state.size()});
  out.values(its_state);
  inner_.keep(out.bytes());
}

void ComponentCheckpoints::take_up() {
  StateReader in(inner_.kept());
  const auto vertices = in.value<std::uint64_t>();
  in.values(std::span(state_.done));
  for (std::size_t c = 0; c < state_.done.size() && in.ok(); ++c) {
    if (state_.done[c] == 0) continue;
    each_number(state_.embeddings[c],
                [&](auto& number) { number = in.value<std::remove_reference_t<decltype(number)>>(); });
    state_.minimum[c] = in.value<double>();
    in.values(part(state_.points, surface_.components[c]));
  }
  begun_ = in.value<std::uint32_t>();
  begun_state_ = in.take(in.value<std::uint64_t>());
  if (!in.ok() || vertices != surface_.mesh.positions.size()) {
    throw Error(ErrorCode::internal, "the checkpoint of an interrupted run does not belong to this model");
  }
}

} // namespace orbis
