// JPEG through libjpeg-turbo. It reports errors by longjmp, which must not cross C++ objects with destructors: all that
// is allocated lives in the caller's structs, and the functions that libjpeg jumps out of hold only plain values.
#include <csetjmp>
#include <cstdio> // jpeglib.h needs it first

#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "core/asset/image_codec.h"
#include "core/asset/image_formats.h"
#include "core/error.h"

namespace orbis::asset {
namespace {

struct ErrorHandler {
  jpeg_error_mgr manager{}; // first: libjpeg knows only this part
  std::jmp_buf back{};

  ErrorHandler() {
    jpeg_std_error(&manager);
    manager.error_exit = [](j_common_ptr codec) {
      std::longjmp(reinterpret_cast<ErrorHandler*>(codec->err)->back, 1); // NOLINT: the way out that libjpeg offers
    };
    // Warnings (level -1) mean lost data, but for stray bytes between markers, which cameras leave behind.
    manager.emit_message = [](j_common_ptr codec, int level) {
      if (level < 0 && codec->err->msg_code != JWRN_EXTRANEOUS_DATA) ++codec->err->num_warnings;
    };
  }
};

// A damaged progressive file may hold scan after scan of nothing, each as costly as the whole image.
constexpr int max_scans = 500;

struct Decoder {
  ErrorHandler errors;
  jpeg_progress_mgr progress{};
  jpeg_decompress_struct codec{};

  Decoder() {
    codec.err = &errors.manager;
    progress.progress_monitor = [](j_common_ptr common) {
      auto* self = reinterpret_cast<j_decompress_ptr>(common);
      if (self->input_scan_number > max_scans) common->err->error_exit(common);
    };
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { jpeg_destroy_decompress(&codec); }
};

bool read_header(Decoder& decoder, std::span<const std::byte> bytes) {
  if (setjmp(decoder.errors.back) != 0) return false;
  jpeg_create_decompress(&decoder.codec);
  decoder.codec.progress = &decoder.progress;
  jpeg_mem_src(&decoder.codec, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&decoder.codec, TRUE);
  return true;
}

bool read_rows(Decoder& decoder, std::uint8_t* pixels, std::size_t row_bytes) {
  if (setjmp(decoder.errors.back) != 0) return false;
  jpeg_start_decompress(&decoder.codec);
  while (decoder.codec.output_scanline < decoder.codec.output_height) {
    JSAMPROW row = pixels + decoder.codec.output_scanline * row_bytes;
    jpeg_read_scanlines(&decoder.codec, &row, 1);
  }
  jpeg_finish_decompress(&decoder.codec);
  return true;
}

// Four channels of ink, stored inverted as Adobe does: light that all of a colour's ink and black let through.
void cmyk_to_rgb(const std::vector<std::uint8_t>& ink, std::vector<std::uint8_t>& pixels, bool inverted) {
  const auto light = [&](std::size_t i) { return inverted ? ink[i] : 255U - ink[i]; };
  for (std::size_t i = 0; i < ink.size() / 4; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      pixels[3 * i + c] = static_cast<std::uint8_t>((light(4 * i + c) * light(4 * i + 3) + 127) / 255);
}

struct Encoder {
  ErrorHandler errors;
  jpeg_compress_struct codec{};
  unsigned char* bytes = nullptr; // malloc'ed by libjpeg
  unsigned long size = 0;

  Encoder() { codec.err = &errors.manager; }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() {
    jpeg_destroy_compress(&codec);
    std::free(bytes); // NOLINT: see above
  }
};

bool write_image(Encoder& encoder, const std::uint8_t* rgb, std::uint32_t width, std::uint32_t height, int quality) {
  if (setjmp(encoder.errors.back) != 0) return false;
  jpeg_compress_struct& codec = encoder.codec;
  jpeg_create_compress(&codec);
  jpeg_mem_dest(&codec, &encoder.bytes, &encoder.size);
  codec.image_width = width;
  codec.image_height = height;
  codec.input_components = 3;
  codec.in_color_space = JCS_RGB;
  jpeg_set_defaults(&codec);
  jpeg_set_quality(&codec, quality, TRUE);
  codec.optimize_coding = TRUE;
  for (int c = 0; c < 3; ++c) codec.comp_info[c].h_samp_factor = codec.comp_info[c].v_samp_factor = 1; // 4:4:4
  jpeg_start_compress(&codec, TRUE);
  while (codec.next_scanline < height) {
    auto* row = const_cast<JSAMPROW>(rgb + std::size_t{codec.next_scanline} * width * 3);
    jpeg_write_scanlines(&codec, &row, 1);
  }
  jpeg_finish_compress(&codec);
  return true;
}

std::vector<std::uint8_t> without_alpha(const texture::Image& image) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(std::size_t{image.width} * image.height * 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (i % image.channels < 3) rgb.push_back(image.pixels[i]);
  return rgb;
}

} // namespace

texture::Image decode_jpeg(const ImageRequest& request) {
  Decoder decoder;
  if (!read_header(decoder, request.bytes)) request.refuse("is damaged: its JPEG header cannot be read");
  jpeg_decompress_struct& codec = decoder.codec;
  request.check_size(codec.image_width, codec.image_height);
  const bool is_cmyk = codec.jpeg_color_space == JCS_CMYK || codec.jpeg_color_space == JCS_YCCK;
  codec.out_color_space = is_cmyk ? JCS_CMYK : JCS_RGB;

  texture::Image image{codec.image_width, codec.image_height, 3, {}};
  const std::size_t count = std::size_t{image.width} * image.height;
  image.pixels.resize(3 * count);
  std::vector<std::uint8_t> ink(is_cmyk ? 4 * count : 0);
  std::uint8_t* target = is_cmyk ? ink.data() : image.pixels.data();
  if (!read_rows(decoder, target, std::size_t{image.width} * (is_cmyk ? 4U : 3U)))
    request.refuse("is damaged: its JPEG data cannot be decoded");
  // libjpeg fills a file that ends too soon with gray and only warns.
  if (codec.err->num_warnings > 0) request.refuse("is damaged: its JPEG data is incomplete");
  if (is_cmyk) cmyk_to_rgb(ink, image.pixels, codec.saw_Adobe_marker != 0);
  return image;
}

std::vector<std::byte> encode_jpeg(const texture::Image& image, int quality) {
  const std::vector<std::uint8_t> stripped = image.channels == 4 ? without_alpha(image) : std::vector<std::uint8_t>{};
  const std::uint8_t* rgb = image.channels == 4 ? stripped.data() : image.pixels.data();
  Encoder encoder;
  if (!write_image(encoder, rgb, image.width, image.height, std::clamp(quality, 1, 100)))
    throw Error(ErrorCode::internal, "an image could not be encoded as JPEG");
  const auto* first = reinterpret_cast<const std::byte*>(encoder.bytes);
  return {first, first + encoder.size};
}

} // namespace orbis::asset
