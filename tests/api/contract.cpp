#include "api/contract.h"

#include <regex>
#include <set>

#include "api/openapi.h"

namespace orbis::test {
namespace {

using Json = nlohmann::json;

const Json& resolve(const Json& node) {
  if (!node.is_object() || !node.contains("$ref")) return node;
  const std::string reference = node["$ref"];
  return resolve(contract().at(Json::json_pointer(reference.substr(1))));
}

bool has_type(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "integer") return value.is_number_integer();
  return type == "number" && value.is_number();
}

std::string check_type(const Json& value, const Json& type, const std::string& place) {
  const Json types = type.is_array() ? type : Json::array({type});
  for (const Json& one : types) {
    if (has_type(value, one)) return "";
  }
  return place + " is " + value.dump() + ", not of type " + type.dump();
}

std::string check_object(const Json& value, const Json& schema, const std::string& place) {
  for (const Json& name : schema.value("required", Json::array())) {
    if (!value.contains(name.get<std::string>())) return place + " lacks " + name.dump();
  }
  const Json properties = schema.value("properties", Json::object());
  for (const auto& [name, member] : value.items()) {
    if (properties.contains(name)) {
      if (auto problem = against_schema(member, properties[name], place + "/" + name); !problem.empty()) return problem;
    } else if (schema.contains("additionalProperties") && schema["additionalProperties"] == false) {
      return place + " has a member " + name + " that the contract does not know";
    }
  }
  return "";
}

std::string check_number(const Json& value, const Json& schema, const std::string& place) {
  const auto number = value.get<double>();
  const bool fits = number >= schema.value("minimum", -1e300) && number <= schema.value("maximum", 1e300) &&
                    number > schema.value("exclusiveMinimum", -1e300) &&
                    number < schema.value("exclusiveMaximum", 1e300);
  return fits ? "" : place + " is " + value.dump() + ", out of range";
}

// The documented path that fits: "/v1/jobs/{id}" for "/v1/jobs/01J".
const Json* path_item(const std::string& path) {
  for (const auto& [pattern, item] : contract()["paths"].items()) {
    const std::string expression = std::regex_replace(pattern, std::regex(R"(\{[a-z]+\})"), "[^/]+");
    if (std::regex_match(path, std::regex(expression))) return &item;
  }
  return nullptr;
}

} // namespace

const Json& contract() {
  static const Json document = Json::parse(api::openapi_json);
  return document;
}

std::string against_schema(const Json& value, const Json& reference, const std::string& place) {
  static const std::set<std::string> known{"type",
                                           "enum",
                                           "properties",
                                           "required",
                                           "additionalProperties",
                                           "items",
                                           "anyOf",
                                           "pattern",
                                           "minimum",
                                           "maximum",
                                           "default",
                                           "maxLength",
                                           "format",
                                           "description",
                                           "examples",
                                           "exclusiveMinimum",
                                           "exclusiveMaximum",
                                           "contentMediaType"};
  const Json& schema = resolve(reference);
  for (const auto& [word, ignored] : schema.items()) {
    if (!known.contains(word)) return place + ": the checker does not know the schema word " + word;
  }
  if (schema.contains("anyOf")) {
    std::string all;
    for (const Json& choice : schema["anyOf"]) {
      const std::string problem = against_schema(value, choice, place);
      if (problem.empty()) return "";
      all += (all.empty() ? "" : "; or ") + problem;
    }
    return all;
  }
  if (schema.contains("type")) {
    if (auto problem = check_type(value, schema["type"], place); !problem.empty()) return problem;
  }
  if (schema.contains("enum") && std::ranges::find(schema["enum"], value) == schema["enum"].end()) {
    return place + " is " + value.dump() + ", not one of " + schema["enum"].dump();
  }
  if (value.is_string() && schema.contains("pattern") &&
      !std::regex_search(value.get<std::string>(), std::regex(schema["pattern"].get<std::string>()))) {
    return place + " is " + value.dump() + ", which does not match " + schema["pattern"].dump();
  }
  if (value.is_number()) return check_number(value, schema, place);
  if (value.is_object()) return check_object(value, schema, place);
  if (value.is_array() && schema.contains("items")) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      auto problem = against_schema(value[i], schema["items"], place + "/" + std::to_string(i));
      if (!problem.empty()) return problem;
    }
  }
  return "";
}

std::string against_contract(const api::Request& request, const api::Response& response) {
  const std::string status = std::to_string(response.status);
  const std::string type(response.header("Content-Type").substr(0, response.header("Content-Type").find(';')));
  const Json* item = path_item(request.path);
  const Json* content = nullptr;
  const std::string method = request.method == "HEAD" ? "get" : api::lower_case(request.method);
  static const Json problem_schema{{"$ref", "#/components/schemas/Problem"}};
  static const Json problem_content{{"application/problem+json", {{"schema", problem_schema}}}};
  if (item == nullptr || !item->contains(method)) {
    // An address or a method that the contract does not have: a problem all the same.
    if (response.status != 404 && response.status != 405) return "an undocumented address answers with " + status;
    content = &problem_content;
  } else {
    const Json& responses = (*item)[method]["responses"];
    const auto documented = responses.contains(status) ? responses.find(status) : responses.find("default");
    if (documented == responses.end()) return method + " " + request.path + ": status " + status + " is not documented";
    const Json& answer = resolve(*documented);
    if (!answer.contains("content")) return type.empty() ? "" : status + " has a body that is not documented";
    content = &answer["content"];
  }
  if (!content->contains(type)) return "content type '" + type + "' is not documented for " + status;
  if ((response.status == 429 || response.status == 503) && response.header("Retry-After").empty())
    return "no Retry-After";
  if (response.status == 401 && response.header("WWW-Authenticate").empty()) return "no WWW-Authenticate";
  if (response.status == 405 && response.header("Allow").empty()) return "no Allow";
  if (!type.ends_with("json") || !std::holds_alternative<std::string>(response.body)) return "";
  const Json body = Json::parse(std::get<std::string>(response.body), nullptr, false);
  if (body.is_discarded()) return "the body is not JSON";
  if (type == "application/problem+json" && body["status"] != response.status) return "the problem has another status";
  return against_schema(body, (*content)[type]["schema"], "");
}

} // namespace orbis::test
