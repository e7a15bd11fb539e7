#include "api/submission.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "api/json.h"
#include "core/check_options.h"
#include "core/model_format.h"

namespace orbis::api {
namespace {

constexpr std::string_view accepted_types = "model/gltf-binary, model/gltf+json, application/vnd.draco, model/obj, "
                                            "application/ply, model/stl, application/zip, "
                                            "application/octet-stream and multipart/form-data";
constexpr std::uint64_t max_options_bytes = 64 << 10;

[[noreturn]] void refuse(Refusal refusal, std::string detail) { throw Refused(refusal, std::move(detail)); }

// At most `limit` bytes of a spooled part.
std::string read_spooled(const Part& part, std::uint64_t limit) {
  std::string text(static_cast<std::size_t>(std::min(part.bytes, limit)), '\0');
  std::ifstream in(part.spooled, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in) throw Error(ErrorCode::internal, "the upload could not be read back");
  return text;
}

Json parse_options_part(const Part& part) {
  if (part.bytes > max_options_bytes) {
    refuse(Refusal::bad_request, "the part 'options' is larger than 64 KiB; it is a JSON object of options");
  }
  const auto shallow = [](int depth, Json::parse_event_t, Json&) { return depth <= 4; };
  Json json = Json::parse(read_spooled(part, max_options_bytes), shallow, false);
  if (!json.is_object()) {
    refuse(Refusal::bad_request, R"(the part 'options' is not a JSON object such as {"texture_size": 2048})");
  }
  return json;
}

// A name as a step of a JSON pointer (RFC 6901).
std::string escaped(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == '~' || c == '/')
      out += c == '~' ? "~0" : "~1";
    else
      out += c;
  }
  return out;
}

// A list of words or numbers is what a query would name with commas between.
std::string option_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  constexpr double exact = 9e15; // 2048.0 is an integer to JSON Schema
  if (value.is_number_float() && std::abs(value.get<double>()) < exact && std::trunc(value.get<double>()) == value)
    return std::to_string(static_cast<std::int64_t>(value.get<double>()));
  const bool is_list = value.is_array() && std::ranges::all_of(value, [](const Json& item) {
                         return item.is_string() || item.is_number();
                       });
  if (!is_list) return dump(value);
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "" : ",") + option_text(item);
  return text;
}

// Collects every bad option, so that the caller can mend them all at once.
Options parse_options(const Request& request, const Part* options_part) {
  std::map<std::string, std::string> values;
  if (options_part != nullptr) {
    const Json json = parse_options_part(*options_part);
    for (const auto& [name, value] : json.items()) values[name] = option_text(value);
  }
  std::vector<FieldError> errors;
  std::set<std::string> in_query;
  for (const auto& [name, value] : request.query) {
    values[name] = value;
    if (!in_query.insert(name).second) errors.push_back({"/" + escaped(name), "'" + name + "' is given twice"});
  }

  Options options;
  for (const auto& [name, value] : values) {
    try {
      set_option(options, name, value);
    } catch (const Error& error) {
      errors.push_back({"/" + escaped(name), error.message()});
    }
  }
  if (!errors.empty()) {
    Problem problem = make_problem(Error(ErrorCode::invalid_option, errors.front().detail));
    if (errors.size() > 1) problem.detail = std::to_string(errors.size()) + " options are invalid; see errors";
    problem.errors = std::move(errors);
    throw Refused(std::move(problem));
  }
  return options;
}

// A first look at the model, so that what can never be read is refused at the door. The reader decides the rest.
void check_format(const Part& model) {
  if (model.bytes == 0) refuse(Refusal::bad_request, "the model is empty");
  const std::string head = read_spooled(model, format_head_bytes);
  if (recognise(head, model.bytes)) return;
  throw Refused(make_problem(Error(ErrorCode::unsupported_format, unrecognised(head, model.bytes))));
}

// What the options need is looked for among the files at once, not when the work comes to it.
void check_options_of(const Submission& submission) {
  std::vector<std::string_view> names;
  for (const Part& file : submission.files) names.emplace_back(file.file_name);
  check_options(submission.options, names);
}

// Options, the model (its name is empty where there is none), and the other parts as files.
Submission parse_parts(const Request& request, std::string_view model_name) {
  Submission submission;
  submission.idempotency_key = request.header("Idempotency-Key");
  if (submission.idempotency_key.size() > 255) {
    refuse(Refusal::bad_request, "the Idempotency-Key is longer than 255 characters");
  }
  const Part* options = nullptr;
  for (const Part& part : request.parts) {
    if (part.name == "options") {
      if (options != nullptr) refuse(Refusal::bad_request, "there are two parts named 'options'");
      options = &part;
    } else if (part.name == model_name) {
      if (!submission.model.name.empty())
        refuse(Refusal::bad_request, "there are two parts named '" + std::string(model_name) + "'");
      submission.model = part;
    } else if (part.file_name.empty()) {
      refuse(Refusal::bad_request, "the part '" + part.name.substr(0, 64) + "' has no file name; parts are '" +
                                       std::string(model_name) + "', 'options', or files that the model names");
    } else {
      if (std::ranges::find(submission.files, part.file_name, &Part::file_name) != submission.files.end())
        refuse(Refusal::bad_request, "there are two files named '" + part.file_name.substr(0, 64) + "'");
      submission.files.push_back(part);
    }
  }
  submission.options = parse_options(request, options);
  return submission;
}

} // namespace

void check_media_type(const Request& request) {
  // curl --data-binary calls any body a web form unless told otherwise, so that name says as little as none: the
  // content decides.
  static constexpr std::array<std::string_view, 14> known{"",
                                                          "application/x-www-form-urlencoded",
                                                          "model/gltf-binary",
                                                          "model/gltf+json",
                                                          "application/vnd.draco",
                                                          "model/obj",
                                                          "application/ply",
                                                          "model/stl",
                                                          "application/sla",
                                                          "application/zip",
                                                          "application/x-zip-compressed",
                                                          "text/plain",
                                                          "application/octet-stream",
                                                          "multipart/form-data"};
  const std::string type = request.media_type();
  if (std::ranges::find(known, type) != known.end()) return;
  refuse(Refusal::unsupported_media_type,
         "'" + type.substr(0, 100) + "' is not accepted; accepted are " + std::string(accepted_types));
}

Submission parse_submission(const Request& request) {
  Submission submission = parse_parts(request, "model");
  if (submission.model.name.empty()) {
    refuse(Refusal::bad_request,
           "there is no model: send it as the body, or as the part 'model' of multipart/form-data");
  }
  check_format(submission.model);
  check_options_of(submission);
  if (!submission.options.morph_to.empty())
    check_format(*std::ranges::find(submission.files, submission.options.morph_to, &Part::file_name));
  return submission;
}

Submission parse_morph(const Request& request) {
  for (const std::string_view name : {"a", "b"}) {
    if (std::ranges::find(request.parts, name, &Part::name) == request.parts.end())
      refuse(Refusal::bad_request,
             "a morph takes two models: send them as the parts 'a' and 'b' of multipart/form-data");
  }
  Submission submission = parse_parts(request, "a");
  const auto second = std::ranges::find(submission.files, std::string_view("b"), &Part::name);
  if (!submission.options.morph_to.empty()) {
    refuse(Refusal::bad_request, "the second model is the part 'b': 'morph_to' is for a job with one model");
  }
  check_format(submission.model);
  check_format(*second);
  submission.options.morph_to = second->file_name;
  check_options_of(submission);
  return submission;
}

} // namespace orbis::api
