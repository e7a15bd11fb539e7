#include <doctest/doctest.h>

#include <png.h>
#include <webp/encode.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>

#include "core/asset/image_codec.h"
#include "core/error.h"

using namespace orbis;
using namespace orbis::asset;
using texture::Image;

namespace {

using Bytes = std::vector<std::byte>;
constexpr std::uint64_t plenty = 1U << 24U;

Image smooth_image(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image{width, height, channels, {}};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (std::uint32_t c = 0; c < channels; ++c)
        image.pixels.push_back(static_cast<std::uint8_t>(128 + 100 * std::sin(0.1 * x * (c + 1) + 0.07 * y)));
  return image;
}

Image noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels, std::uint32_t seed) {
  std::mt19937 random(seed);
  Image image{width, height, channels, {}};
  for (std::size_t i = 0; i < std::size_t{width} * height * channels; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>(random()));
  return image;
}

Bytes encode_webp(const Image& image) {
  std::uint8_t* data = nullptr;
  const auto stride = static_cast<int>(image.width * image.channels);
  const auto width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const std::size_t size = image.channels == 4
                               ? WebPEncodeLosslessRGBA(image.pixels.data(), width, height, stride, &data)
                               : WebPEncodeLosslessRGB(image.pixels.data(), width, height, stride, &data);
  const auto* first = reinterpret_cast<const std::byte*>(data);
  Bytes bytes(first, first + size);
  WebPFree(data);
  return bytes;
}

// A PNG of any colour type, written by libpng itself. row(y, out) fills a row.
Bytes raw_png(std::uint32_t width, std::uint32_t height, int bits, int color, bool interlaced,
              const std::function<void(png_structp, png_infop)>& extra,
              const std::function<void(std::uint32_t, std::vector<std::uint8_t>&)>& row) {
  Bytes bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, std::size_t n) {
        auto& out = *static_cast<Bytes*>(png_get_io_ptr(p));
        const auto* first = reinterpret_cast<const std::byte*>(data);
        out.insert(out.end(), first, first + n);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, bits, color, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  extra(png, info);
  png_write_info(png, info);
  const int passes = interlaced ? png_set_interlace_handling(png) : 1;
  for (int pass = 0; pass < passes; ++pass)
    for (std::uint32_t y = 0; y < height; ++y) {
      std::vector<std::uint8_t> line(png_get_rowbytes(png, info));
      row(y, line);
      png_write_row(png, line.data());
    }
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

ErrorCode code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    CHECK(e.where() == "/images/3");
    return e.code();
  }
  FAIL("nothing was thrown");
  return ErrorCode::internal;
}

} // namespace

TEST_CASE("PNG keeps every byte, with and without alpha, at every size") {
  for (const std::uint32_t channels : {3U, 4U})
    for (const std::uint32_t width : {1U, 2U, 7U, 64U, 301U}) {
      const Image image = noise(width, 1 + width / 2, channels, width);
      const Image back = decode_image(encode_png(image), plenty, "");
      CHECK(back.width == image.width);
      CHECK(back.height == image.height);
      CHECK(back.channels == image.channels);
      CHECK(back.pixels == image.pixels);
      CHECK(encode_png(image) == encode_png(image));
    }
}

TEST_CASE("JPEG comes close at high quality, drops alpha, and is the same twice") {
  const Image image = smooth_image(97, 61, 4);
  const Bytes bytes = encode_jpeg(image, 95);
  CHECK(bytes == encode_jpeg(image, 95));
  const Image back = decode_image(bytes, plenty, "");
  REQUIRE(back.channels == 3);
  REQUIRE(back.width == 97);
  REQUIRE(back.height == 61);
  int worst = 0;
  for (std::uint32_t y = 0; y < 61; ++y)
    for (std::uint32_t x = 0; x < 97; ++x)
      for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(back.at(x, y)[c] - image.at(x, y)[c]));
  CHECK(worst < 16);
  CHECK(encode_jpeg(image, 30).size() < bytes.size());
}

TEST_CASE("lossless WebP is read to the byte") {
  for (const std::uint32_t channels : {3U, 4U}) {
    Image image = noise(33, 21, channels, 5);
    // WebP need not keep the colour of what cannot be seen.
    for (std::size_t i = 3; channels == 4 && i < image.pixels.size(); i += 4) image.pixels[i] |= 1U;
    CHECK(decode_image(encode_webp(image), plenty, "").pixels == image.pixels);
  }
}

TEST_CASE("gray, palette, 16-bit, transparent-colour and interlaced PNG become 8-bit RGB or RGBA") {
  const auto nothing = [](png_structp, png_infop) {};
  const auto ramp = [](std::uint32_t y, std::vector<std::uint8_t>& line) {
    for (std::size_t i = 0; i < line.size(); ++i) line[i] = static_cast<std::uint8_t>(16 * y + i);
  };
  SUBCASE("gray, interlaced") {
    const Image image = decode_image(raw_png(9, 11, 8, PNG_COLOR_TYPE_GRAY, true, nothing, ramp), plenty, "");
    REQUIRE(image.channels == 3);
    for (int c = 0; c < 3; ++c) CHECK(image.at(5, 7)[c] == 16 * 7 + 5);
  }
  SUBCASE("gray, 1 bit") {
    const Image image = decode_image(raw_png(8, 2, 1, PNG_COLOR_TYPE_GRAY, false, nothing,
                                             [](std::uint32_t, std::vector<std::uint8_t>& line) { line[0] = 0x40; }),
                                     plenty, "");
    CHECK(image.at(0, 0)[0] == 0);
    CHECK(image.at(1, 1)[2] == 255);
  }
  SUBCASE("16 bits with alpha") {
    const Image image =
        decode_image(raw_png(2, 1, 16, PNG_COLOR_TYPE_RGB_ALPHA, false, nothing,
                             [](std::uint32_t, std::vector<std::uint8_t>& line) {
                               line = {0xff, 0xff, 0x80, 0x80, 0, 0, 0x40, 0x40, 1, 2, 3, 4, 5, 6, 7, 8};
                             }),
                     plenty, "");
    REQUIRE(image.channels == 4);
    CHECK(std::vector<int>(image.pixels.begin(), image.pixels.begin() + 4) == std::vector<int>{255, 128, 0, 64});
  }
  SUBCASE("palette with a transparent entry") {
    const auto palette = [](png_structp png, png_infop info) {
      const png_color colors[] = {{10, 20, 30}, {40, 50, 60}};
      const png_byte alpha[] = {0};
      png_set_PLTE(png, info, colors, 2);
      png_set_tRNS(png, info, alpha, 1, nullptr);
    };
    const Image image = decode_image(raw_png(8, 1, 1, PNG_COLOR_TYPE_PALETTE, false, palette,
                                             [](std::uint32_t, std::vector<std::uint8_t>& line) { line[0] = 0x7f; }),
                                     plenty, "");
    REQUIRE(image.channels == 4);
    CHECK(std::vector<int>(image.pixels.begin(), image.pixels.begin() + 8) ==
          std::vector<int>{10, 20, 30, 0, 40, 50, 60, 255});
  }
}

TEST_CASE("an image of more pixels than allowed is refused before it is decoded") {
  const Image image = smooth_image(100, 50, 3);
  for (const Bytes& bytes : {encode_png(image), encode_jpeg(image, 80), encode_webp(image)}) {
    CHECK(decode_image(bytes, 5000, "/images/3").width == 100);
    CHECK(code_of([&] { (void)decode_image(bytes, 4999, "/images/3"); }) == ErrorCode::too_large);
  }
}

TEST_CASE("what is no image, or half of one, is refused with its place") {
  CHECK(code_of([] { (void)decode_image({}, plenty, "/images/3"); }) == ErrorCode::unsupported_format);
  const std::string text = "GIF89a, once upon a time";
  CHECK(code_of([&] { (void)decode_image(std::as_bytes(std::span(text)), plenty, "/images/3"); }) ==
        ErrorCode::unsupported_format);
  const Image image = noise(64, 64, 3, 9);
  for (const Bytes& bytes : {encode_png(image), encode_jpeg(image, 80), encode_webp(image)})
    for (const std::size_t kept : {std::size_t{12}, bytes.size() / 3, bytes.size() / 2}) {
      CAPTURE(kept);
      CHECK(code_of([&] { (void)decode_image(std::span(bytes).first(kept), plenty, "/images/3"); }) ==
            ErrorCode::malformed);
    }
}

TEST_CASE("damaged images are refused or decoded, never more") {
  std::mt19937 random(17);
  const Image image = noise(24, 18, 4, 3);
  int refused = 0, decoded = 0;
  for (const Bytes& bytes : {encode_png(image), encode_jpeg(image, 60), encode_webp(image)})
    for (int round = 0; round < 400; ++round) {
      Bytes damaged = bytes;
      for (int hits = 1 + round % 5; hits > 0; --hits)
        damaged[12 + random() % (damaged.size() - 12)] = static_cast<std::byte>(random());
      if (round % 7 == 0) damaged.resize(12 + random() % (damaged.size() - 12));
      try {
        const Image result = decode_image(damaged, 1U << 20U, "/images/3");
        CHECK(result.pixels.size() == std::size_t{result.width} * result.height * result.channels);
        ++decoded;
      } catch (const Error& e) {
        CHECK((e.code() == ErrorCode::malformed || e.code() == ErrorCode::too_large));
        CHECK(e.where() == "/images/3");
        ++refused;
      }
    }
  CHECK(refused > 0);
  CHECK(decoded > 0);
}
