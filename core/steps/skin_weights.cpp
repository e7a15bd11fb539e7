#include "core/steps/skin_weights.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace orbis {
namespace {

using asset::Attribute;
using asset::ComponentType;

// Set n of a vertex' influences: JOINTS_n and WEIGHTS_n, as places in the attribute list.
struct InfluenceSet {
  std::size_t joints, weights;
};

std::vector<InfluenceSet> find_sets(std::span<const Attribute> attributes) {
  const auto place_of = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(attributes, name, &Attribute::name) - attributes.begin());
  };
  std::vector<InfluenceSet> sets;
  for (int n = 0;; ++n) {
    const InfluenceSet set{place_of("JOINTS_" + std::to_string(n)), place_of("WEIGHTS_" + std::to_string(n))};
    if (set.joints == attributes.size() || set.weights == attributes.size()) return sets;
    sets.push_back(set);
  }
}

struct Influence {
  double joint;
  double weight;
};

std::vector<Influence> merged(std::span<const Attribute> attributes, std::span<const InfluenceSet> sets,
                              const VertexSource& source) {
  std::vector<Influence> all;
  for (const InfluenceSet& set : sets) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::uint32_t c = 0; c < attributes[set.weights].components; ++c) {
        const double weight = source.weights[k] * attributes[set.weights].get(source.corners[k], c);
        if (!(weight > 0)) continue;
        const double joint = attributes[set.joints].get(source.corners[k], c);
        const auto known = std::ranges::find(all, joint, &Influence::joint);
        if (known == all.end()) {
          all.push_back({joint, weight});
        } else {
          known->weight += weight;
        }
      }
    }
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &Influence::weight);
  return all;
}

// Brings the weights to sum 1; for integer types to multiples of 1 / steps with the rounding left to the strongest.
void normalise(std::vector<Influence>& influences, double steps) {
  double sum = 0;
  for (const Influence& i : influences) sum += i.weight;
  double rest = 1;
  for (Influence& i : influences) {
    i.weight /= sum;
    if (steps > 0) i.weight = std::floor(i.weight * steps + 0.5) / steps;
    rest -= i.weight;
  }
  influences.front().weight += rest;
  // A weight that rounded to nothing would leave a joint without weight.
  std::erase_if(influences, [](const Influence& i) { return !(i.weight > 0); });
}

double steps_of(const Attribute& weights) {
  if (weights.type == ComponentType::u8) return 255;
  if (weights.type == ComponentType::u16) return 65535;
  return 0;
}

} // namespace

void merge_skin_weights(std::span<const Attribute> attributes, std::span<const VertexSource> sources,
                        std::vector<Attribute>& out) {
  const std::vector<InfluenceSet> sets = find_sets(attributes);
  if (sets.empty()) return;
  const std::uint32_t per_set = attributes[sets[0].weights].components;
  for (std::size_t w = 0; w < sources.size(); ++w) {
    if (sources[w].copied() >= 0) continue;
    std::vector<Influence> influences = merged(attributes, sets, sources[w]);
    if (influences.empty()) continue; // no corner has any: the copied zeros stay
    influences.resize(std::min(influences.size(), sets.size() * per_set));
    normalise(influences, steps_of(attributes[sets[0].weights]));
    for (std::size_t slot = 0; slot < sets.size() * per_set; ++slot) {
      const InfluenceSet& set = sets[slot / per_set];
      const auto c = static_cast<std::uint32_t>(slot % per_set);
      const Influence i = slot < influences.size() ? influences[slot] : Influence{0, 0};
      out[set.joints].set(w, c, i.joint);
      out[set.weights].set(w, c, i.weight);
    }
  }
}

} // namespace orbis
