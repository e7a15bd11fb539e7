// Checks answers against the contract, api/openapi.yaml.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "api/http.h"

namespace orbis::test {

// What a value has against a schema of the contract: "" or a sentence with the place. Knows the words that the contract
// uses ($ref, type, enum, properties, required, additionalProperties, items, anyOf, pattern, minimum, maximum,
// exclusiveMinimum, exclusiveMaximum, maxLength) and reports any other word that could restrict a value.
[[nodiscard]] std::string against_schema(const nlohmann::json& value, const nlohmann::json& schema,
                                         const std::string& place = "");

// What an answer has against the contract: is the status documented for that path and method, is the content type, has
// JSON the schema's shape, are the headers there that the contract promises for refusals?
[[nodiscard]] std::string against_contract(const api::Request& request, const api::Response& response);

// The whole contract.
[[nodiscard]] const nlohmann::json& contract();

} // namespace orbis::test
