// PNG, written here so that several threads can share the work: bands of rows are filtered and compressed by
// themselves, and their deflate streams are joined (RFC 1950, 1951; a band ends on a byte with an empty stored block).
//
// Filters: per row whichever of Sub, Up and Paeth leaves the smallest sum of magnitudes (the PNG specification's own
// heuristic). Compression: run lengths and Huffman codes only. On photographs filtered that way this takes a third of
// the time of a search for repetitions and is not larger (measured in docs/benchmarks.md).
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "core/asset/image_codec.h"
#include "core/error.h"
#include "core/mesh/thread_pool.h"

namespace orbis::asset {
namespace {

constexpr std::size_t band_bytes = 1U << 19U; // of pixels, about
constexpr int compression_level = 6;          // of no weight with run lengths, but for the size of the blocks

// Rows as PNG stores them: 16-bit samples with the high byte first.
struct Pixels {
  std::uint32_t width, height, channels, bits;
  std::span<const std::uint8_t> bytes;    // 8 bits
  std::span<const std::uint16_t> samples; // 16 bits

  [[nodiscard]] std::size_t pixel_bytes() const { return std::size_t{channels} * bits / 8; }
  [[nodiscard]] std::size_t row_bytes() const { return width * pixel_bytes(); }
  void copy_row(std::uint32_t y, std::uint8_t* to) const {
    const std::size_t count = std::size_t{width} * channels, first = y * count;
    if (bits == 8) {
      std::memcpy(to, bytes.data() + first, count);
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      to[2 * i] = static_cast<std::uint8_t>(samples[first + i] >> 8U);
      to[2 * i + 1] = static_cast<std::uint8_t>(samples[first + i] & 255U);
    }
  }
};

std::uint8_t paeth(int left, int up, int corner) {
  const int to_left = std::abs(up - corner), to_up = std::abs(left - corner);
  const int to_corner = std::abs(left + up - 2 * corner);
  if (to_left <= to_up && to_left <= to_corner) return static_cast<std::uint8_t>(left);
  return static_cast<std::uint8_t>(to_up <= to_corner ? up : corner);
}

class RowFilter {
public:
  explicit RowFilter(std::size_t row_bytes, std::size_t pixel_bytes) : step_(pixel_bytes) {
    for (Candidate& c : candidates_) c.bytes.resize(row_bytes);
  }

  // Writes the filter's code and the filtered row.
  void write(const std::uint8_t* row, const std::uint8_t* above, std::uint8_t* to) {
    apply(candidates_[0], row, above, [](int left, int, int) { return left; });
    apply(candidates_[1], row, above, [](int, int up, int) { return up; });
    apply(candidates_[2], row, above, [](int left, int up, int corner) { return paeth(left, up, corner); });
    const auto* best = std::min_element(candidates_.begin(), candidates_.end(),
                                        [](const Candidate& a, const Candidate& b) { return a.sum < b.sum; });
    to[0] = best->code;
    std::memcpy(to + 1, best->bytes.data(), best->bytes.size());
  }

private:
  struct Candidate {
    std::uint8_t code;
    std::vector<std::uint8_t> bytes{};
    std::uint64_t sum = 0; // of the magnitudes, as signed bytes
  };

  template <class Predict>
  void apply(Candidate& c, const std::uint8_t* row, const std::uint8_t* above, Predict predict) const {
    const std::size_t count = c.bytes.size();
    for (std::size_t i = 0; i < step_; ++i) c.bytes[i] = static_cast<std::uint8_t>(row[i] - predict(0, above[i], 0));
    for (std::size_t i = step_; i < count; ++i) {
      c.bytes[i] = static_cast<std::uint8_t>(row[i] - predict(row[i - step_], above[i], above[i - step_]));
    }
    c.sum = 0;
    for (const std::uint8_t b : c.bytes) c.sum += static_cast<std::uint64_t>(std::abs(static_cast<std::int8_t>(b)));
  }

  std::size_t step_;
  std::array<Candidate, 3> candidates_{{{1}, {2}, {4}}};
};

// A band of rows: its part of the deflate stream, and the checksum of what it holds.
struct Band {
  std::vector<std::byte> deflated;
  uLong adler = 0;
  std::size_t filtered_bytes = 0;
  bool failed = false;
};

std::vector<std::uint8_t> filtered_rows(const Pixels& pixels, std::uint32_t begin, std::uint32_t end) {
  const std::size_t row_bytes = pixels.row_bytes();
  std::vector<std::uint8_t> out((end - begin) * (row_bytes + 1)), row(row_bytes), above(row_bytes, 0);
  if (begin > 0) pixels.copy_row(begin - 1, above.data());
  RowFilter filter(row_bytes, pixels.pixel_bytes());
  for (std::uint32_t y = begin; y < end; ++y) {
    pixels.copy_row(y, row.data());
    filter.write(row.data(), above.data(), out.data() + (y - begin) * (row_bytes + 1));
    row.swap(above);
  }
  return out;
}

Band compress(std::vector<std::uint8_t> filtered, bool last) {
  Band band;
  band.filtered_bytes = filtered.size();
  band.adler = adler32(adler32(0, nullptr, 0), filtered.data(), static_cast<uInt>(filtered.size()));
  z_stream stream{};
  constexpr int raw_deflate = -15, memory_level = 9;
  if (deflateInit2(&stream, compression_level, Z_DEFLATED, raw_deflate, memory_level, Z_RLE) != Z_OK) {
    band.failed = true;
    return band;
  }
  constexpr std::size_t flush_bytes = 16; // the empty block at the end
  band.deflated.resize(deflateBound(&stream, static_cast<uLong>(filtered.size())) + flush_bytes);
  stream.next_in = filtered.data();
  stream.avail_in = static_cast<uInt>(filtered.size());
  stream.next_out = reinterpret_cast<Bytef*>(band.deflated.data());
  stream.avail_out = static_cast<uInt>(band.deflated.size());
  const int result = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
  band.failed = result != (last ? Z_STREAM_END : Z_OK) || stream.avail_in != 0;
  band.deflated.resize(stream.total_out);
  deflateEnd(&stream);
  return band;
}

std::vector<Band> compress_bands(const Pixels& pixels, std::uint32_t threads) {
  const auto rows = static_cast<std::uint32_t>(std::max<std::size_t>(band_bytes / pixels.row_bytes(), 1));
  const std::uint32_t count = (pixels.height + rows - 1) / rows;
  std::vector<Band> bands(count);
  mesh::ThreadPool pool(threads);
  pool.for_blocks(count, 1, [&](std::size_t i, std::size_t) {
    const auto begin = static_cast<std::uint32_t>(i) * rows, end = std::min(begin + rows, pixels.height);
    try {
      bands[i] = compress(filtered_rows(pixels, begin, end), i + 1 == count);
    } catch (const std::bad_alloc&) {
      bands[i].failed = true; // no exception may leave a pool's loop
    }
  });
  if (std::any_of(bands.begin(), bands.end(), [](const Band& b) { return b.failed; })) {
    throw Error(ErrorCode::out_of_memory, "there is no memory to encode an image");
  }
  return bands;
}

class ChunkWriter {
public:
  void number(std::uint64_t value) { // 4 bytes, the highest first
    for (unsigned shift = 32; shift > 0;) out_.push_back(static_cast<std::byte>(value >> (shift -= 8U) & 255U));
  }
  void chunk(std::string_view type, std::span<const std::byte> data) {
    number(data.size());
    const std::size_t start = out_.size();
    for (const char c : type) out_.push_back(static_cast<std::byte>(c));
    out_.insert(out_.end(), data.begin(), data.end());
    const auto* checked = reinterpret_cast<const Bytef*>(out_.data() + start);
    number(crc32(crc32(0, nullptr, 0), checked, static_cast<uInt>(out_.size() - start)));
  }
  void bytes(std::initializer_list<int> values) {
    for (const int value : values) out_.push_back(static_cast<std::byte>(value));
  }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(out_); }

private:
  std::vector<std::byte> out_;
};

std::vector<std::byte> header_of(const Pixels& pixels) {
  constexpr int grey = 0, rgb = 2, rgba = 6;
  const int type = pixels.channels == 1 ? grey : pixels.channels == 3 ? rgb : rgba;
  ChunkWriter header;
  header.number(pixels.width);
  header.number(pixels.height);
  header.bytes({static_cast<int>(pixels.bits), type, 0, 0, 0});
  return header.take();
}

std::vector<std::byte> encode(const Pixels& pixels, texture::Encoding encoding, std::uint32_t threads) {
  std::vector<Band> bands = compress_bands(pixels, threads);
  ChunkWriter file;
  file.bytes({0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'});
  file.chunk("IHDR", header_of(pixels));
  if (encoding == texture::Encoding::srgb) file.chunk("sRGB", std::array{std::byte{0}});
  // One stream over all chunks: its header before the first band, its checksum behind the last.
  uLong adler = adler32(0, nullptr, 0);
  for (const Band& band : bands) {
    adler = adler32_combine(adler, band.adler, static_cast<z_off_t>(band.filtered_bytes));
  }
  bands.front().deflated.insert(bands.front().deflated.begin(), {std::byte{0x78}, std::byte{0x01}});
  ChunkWriter checksum;
  checksum.number(adler);
  const std::vector<std::byte> end = checksum.take();
  bands.back().deflated.insert(bands.back().deflated.end(), end.begin(), end.end());
  for (const Band& band : bands) file.chunk("IDAT", band.deflated);
  file.chunk("IEND", {});
  return file.take();
}

} // namespace

std::vector<std::byte> encode_png(const texture::Image& image, texture::Encoding encoding, std::uint32_t threads) {
  return encode({image.width, image.height, image.channels, 8, image.pixels, {}}, encoding, threads);
}

std::vector<std::byte> encode_png(const texture::Image16& image, texture::Encoding encoding, std::uint32_t threads) {
  return encode({image.width, image.height, image.channels, 16, {}, image.pixels}, encoding, threads);
}

} // namespace orbis::asset
