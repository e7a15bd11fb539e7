#include <doctest/doctest.h>

#include <random>

#include "core/sphere/distortion_energy.h"

using namespace orbis;
using sphere::StarTerm;

namespace {

// A star of n triangles around a point, everything at random but positively oriented.
std::vector<StarTerm> random_star(std::mt19937& random, Vec3d& centre) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<float> angle(-0.5F, 3), area(0.01F, 1);
  centre = normalized(Vec3d{normal(random), normal(random), normal(random)});
  const sphere::TangentFrame frame(centre);
  const std::size_t n = 3 + random() % 6;
  std::vector<Vec3d> ring;
  for (std::size_t k = 0; k < n; ++k) {
    const double a = 2 * std::numbers::pi * (static_cast<double>(k) + 0.3 * std::abs(std::sin(normal(random)))) /
                     static_cast<double>(n);
    ring.push_back(normalized(centre + 0.3 * (std::cos(a) * frame.x + std::sin(a) * frame.y)));
  }
  std::vector<StarTerm> star;
  for (std::size_t k = 0; k < n; ++k) {
    const sphere::Reference reference{{angle(random), angle(random), angle(random)}, area(random)};
    star.push_back(sphere::make_term(ring[k], ring[(k + 1) % n], reference, random() % 3));
  }
  return star;
}

const std::vector<sphere::TriangleEnergy> family{sphere::SymmetricDirichlet{}, sphere::Stretch{},
                                                 sphere::AreaWeighted{0}, sphere::AreaWeighted{0.3}};

// Calls body(energy) for every member of the family.
template <class Body> void for_each_energy(Body body) {
  for (const sphere::TriangleEnergy& energy : family) {
    CAPTURE(energy.index());
    std::visit(body, energy);
  }
}

} // namespace

TEST_CASE("the derivatives of h agree with finite differences") {
  for_each_energy([](const auto& energy) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> logarithm(-6, 6);
    for (int i = 0; i < 1000; ++i) {
      const double area = std::exp(logarithm(random)), V = area * std::exp(logarithm(random)), d = 1e-4 * V;
      const sphere::Jet jet = energy.jet(V, area);
      const double high = energy.value(V + d, area), low = energy.value(V - d, area), here = energy.value(V, area);
      CHECK(jet.value == doctest::Approx(here).epsilon(1e-12));
      CHECK(std::abs(jet.first * V - (high - low) / (2 * d) * V) < 1e-6 * here);
      CHECK(std::abs(jet.second * V * V - (high - 2 * here + low) / (d * d) * V * V) < 1e-5 * here);
    }
  });
}

TEST_CASE("the area-weighted energy at weight 1 is the symmetric Dirichlet energy") {
  for (const double V : {0.01, 0.3, 1.0, 7.0}) {
    CHECK(sphere::AreaWeighted{1}.value(V, 0.4) ==
          doctest::Approx(sphere::SymmetricDirichlet{}.value(V, 0.4)).epsilon(1e-6));
  }
}

TEST_CASE("gradient and Hessian agree with finite differences") {
  for_each_energy([](const auto& energy) {
    std::mt19937 random(3);
    for (int i = 0; i < 200; ++i) {
      Vec3d p;
      const std::vector<StarTerm> star = random_star(random, p);
      const sphere::TangentFrame frame(p);
      const sphere::Expansion e = sphere::expand(energy, star, p, frame);
      const double h = 1e-5;
      const auto at = [&](double x, double y) {
        return sphere::star_energy(energy, star, normalized(p + x * frame.x + y * frame.y));
      };
      const double scale = std::abs(e.energy) + std::abs(e.hxx) + std::abs(e.hyy);
      CHECK(e.energy == doctest::Approx(at(0, 0)));
      CHECK(std::abs(e.gx - (at(h, 0) - at(-h, 0)) / (2 * h)) < 1e-6 * scale);
      CHECK(std::abs(e.gy - (at(0, h) - at(0, -h)) / (2 * h)) < 1e-6 * scale);
      const double H = 1e-4;
      CHECK(std::abs(e.hxx - (at(H, 0) - 2 * at(0, 0) + at(-H, 0)) / (H * H)) < 1e-3 * scale);
      CHECK(std::abs(e.hyy - (at(0, H) - 2 * at(0, 0) + at(0, -H)) / (H * H)) < 1e-3 * scale);
      CHECK(std::abs(e.hxy - (at(H, H) - at(H, -H) - at(-H, H) + at(-H, -H)) / (4 * H * H)) < 1e-3 * scale);
    }
  });
}

TEST_CASE("the tangent frame is orthonormal and right-handed everywhere") {
  for (const Vec3d p : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, Vec3d{1, 0, 0}, normalized(Vec3d{1, -2, -1e-9})}) {
    const sphere::TangentFrame f(p);
    CHECK(norm(cross(f.x, f.y) - p) < 1e-12);
    CHECK(std::abs(dot(f.x, f.y)) < 1e-12);
  }
}

TEST_CASE("a step never raises the energy and never folds a triangle") {
  for_each_energy([](const auto& energy) {
    std::mt19937 random(4);
    for (int i = 0; i < 500; ++i) {
      Vec3d p;
      const std::vector<StarTerm> star = random_star(random, p);
      double value = sphere::star_energy(energy, star, p);
      for (int step = 0; step < 5; ++step) {
        double gain = 0;
        p = sphere::newton_step(energy, star, p, gain);
        const double now = sphere::star_energy(energy, star, p);
        CHECK(now <= value * (1 + 1e-14)); // the two sums round in different orders
        CHECK(std::abs(norm(p) - 1) < 1e-12);
        value = now;
      }
    }
  });
}

TEST_CASE("an isometric triangle has its own area as energy, whatever the energy") {
  // A tiny equilateral triangle on the sphere against a reference of the same size.
  const double s = 1e-4;
  const Vec3d a = normalized(Vec3d{0, 0, 1}), b = normalized(Vec3d{s, 0, 1}),
              c = normalized(Vec3d{s / 2, s * std::sqrt(3) / 2, 1});
  const auto cot = static_cast<float>(1 / std::sqrt(3));
  const double area = s * s * std::sqrt(3) / 4;
  const StarTerm t = sphere::make_term(b, c, {{cot, cot, cot}, static_cast<float>(area)}, 0);
  for_each_energy([&](const auto& energy) {
    CHECK(sphere::star_energy(energy, std::span(&t, 1), a) == doctest::Approx(area).epsilon(1e-6));
  });
}
