#include "core/asset/zip.h"

#include <zip.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

constexpr std::uint64_t max_members = 4096, max_ratio = 200, ratio_begins = 1 << 20;

struct Closer {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using Archive = std::unique_ptr<zip_t, Closer>;

struct Member {
  std::uint64_t index = 0;
  std::string name;     // in UTF-8; where the archive does not say how it is encoded, libzip takes it for code page 437
  std::string raw_name; // its bytes in the archive
  std::uint64_t bytes = 0;
};

[[noreturn]] void refuse(const std::string& message, ErrorCode code = ErrorCode::malformed) {
  throw Error(code, "the zip archive " + message);
}

std::string quoted(std::string_view name) { return std::string(1, '\'').append(shown(name)).append(1, '\''); }

Archive open_archive(std::span<const std::byte> bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  zip_t* archive = source ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr;
  if (!archive && source) zip_source_free(source);
  zip_error_fini(&error);
  if (!archive) refuse("is damaged: it has no readable directory");
  return Archive(archive);
}

// A relative path with '/' that never leads out.
bool stays_inside(std::string_view name) {
  if (name.empty() || name.front() == '/' || name.find('\\') != std::string_view::npos) return false;
  if (name.find(':') != std::string_view::npos || name.find('\0') != std::string_view::npos) return false;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find('/'), name.size());
    if (name.substr(0, end) == "..") return false;
    name.remove_prefix(std::min(name.size(), end + 1));
  }
  return true;
}

// What file managers leave behind.
bool is_litter(std::string_view name) {
  const std::string_view file = name.substr(name.rfind('/') + 1);
  return name.starts_with("__MACOSX/") || file.starts_with("._") || file == ".DS_Store" || file == "Thumbs.db";
}

Member checked_member(zip_t* archive, std::uint64_t index) {
  zip_stat_t stat;
  constexpr zip_uint64_t needed = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD;
  if (zip_stat_index(archive, index, 0, &stat) != 0 || (stat.valid & needed) != needed) {
    refuse("is damaged: its entry " + std::to_string(index) + " cannot be read");
  }
  const char* raw = zip_get_name(archive, index, ZIP_FL_ENC_RAW);
  const std::string name = stat.name, raw_name = raw ? raw : name;
  if (!stays_inside(name) || !stays_inside(raw_name)) {
    refuse("has a member " + quoted(name) + " whose name leads out of the archive; names are relative, with '/'");
  }
  if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) && stat.encryption_method != ZIP_EM_NONE) {
    refuse("is encrypted; send it without a password", ErrorCode::unsupported_feature);
  }
  if (stat.comp_method != ZIP_CM_STORE && stat.comp_method != ZIP_CM_DEFLATE) {
    refuse("compresses " + quoted(name) + " by a method other than 'deflate'; pack it again with that",
           ErrorCode::unsupported_feature);
  }
  if (stat.size > ratio_begins && stat.size / max_ratio > stat.comp_size) {
    refuse("has a member " + quoted(name) + " that claims to inflate to more than " + std::to_string(max_ratio) +
               " times its size",
           ErrorCode::too_large);
  }
  return {index, name, raw_name, stat.size};
}

std::vector<Member> checked_members(zip_t* archive, const Limits& limits) {
  const auto count = static_cast<std::uint64_t>(zip_get_num_entries(archive, 0));
  if (count > max_members) {
    refuse("has " + std::to_string(count) + " members, more than the limit of " + std::to_string(max_members),
           ErrorCode::too_large);
  }
  std::vector<Member> members;
  std::uint64_t total = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    Member member = checked_member(archive, i);
    if (member.name.back() == '/' || is_litter(member.name)) continue;
    const std::uint64_t copies = member.raw_name == member.name ? 1 : 2; // one under each name
    if (member.bytes > limits.max_bytes || (total += copies * member.bytes) > limits.max_bytes) {
      refuse("holds more than the limit of " + std::to_string(limits.max_bytes) + " bytes", ErrorCode::too_large);
    }
    members.push_back(std::move(member));
  }
  return members;
}

Bytes contents(zip_t* archive, const Member& member) {
  const std::unique_ptr<zip_file_t, Closer> file(zip_fopen_index(archive, member.index, 0));
  if (!file) refuse("is damaged: " + quoted(member.name) + " cannot be read");
  Bytes out(member.bytes);
  std::uint64_t got = 0;
  for (zip_int64_t n = 1; n > 0 && got < out.size(); got += static_cast<std::uint64_t>(n)) {
    n = zip_fread(file.get(), out.data() + got, out.size() - got);
    if (n < 0) refuse("is damaged: " + quoted(member.name) + " does not inflate to what it should be");
  }
  // The checksum is looked at when the end is reached.
  std::byte beyond{};
  if (got < out.size() || zip_fread(file.get(), &beyond, 1) != 0) {
    refuse("is damaged: " + quoted(member.name) + " does not have the size or the checksum that it should have");
  }
  return out;
}

bool is_model(std::string_view name) {
  constexpr std::array<std::string_view, 6> endings{".glb", ".gltf", ".drc", ".obj", ".ply", ".stl"};
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return false;
  std::string ending(name.substr(dot));
  for (char& c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 'a' - 'A' : c);
  return std::ranges::find(endings, ending) != endings.end();
}

const Member& the_model(const std::vector<Member>& members) {
  const Member* model = nullptr;
  for (const Member& member : members) {
    if (!is_model(member.name)) continue;
    if (model) {
      refuse("holds more than one model: " + quoted(model->name) + " and " + quoted(member.name) +
                 "; send one at a time",
             ErrorCode::unsupported_feature);
    }
    model = &member;
  }
  if (!model) {
    refuse("holds no model: no member ends with .glb, .gltf, .drc, .obj, .ply or .stl", ErrorCode::missing_resource);
  }
  return *model;
}

std::string folder_of(const std::string& name) { return name.substr(0, name.rfind('/') + 1); }

// "scene/textures/a.png" from "scene/" -> "textures/a.png"; "b.png" from "scene/" -> "../b.png".
std::string path_from(std::string_view folder, std::string_view name) {
  std::string up;
  while (!name.starts_with(folder)) {
    folder.remove_suffix(1);
    folder = folder.substr(0, folder.rfind('/') + 1);
    up += "../";
  }
  return up + std::string(name.substr(folder.size()));
}

} // namespace

ZippedModel unzip_model(std::span<const std::byte> bytes, const Limits& limits) {
  const Archive archive = open_archive(bytes);
  const std::vector<Member> members = checked_members(archive.get(), limits);
  const Member& model = the_model(members);
  const std::string folder = folder_of(model.name), raw_folder = folder_of(model.raw_name);
  ZippedModel out{model.name, contents(archive.get(), model), {}};
  for (const Member& member : members) {
    if (&member == &model) continue;
    Bytes& file = out.files[path_from(folder, member.name)];
    file = contents(archive.get(), member);
    // An OBJ names its files by the same bytes, whatever they mean.
    if (member.raw_name != member.name) out.files[path_from(raw_folder, member.raw_name)] = file;
  }
  return out;
}

} // namespace orbis::asset
