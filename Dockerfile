# Two stages on Debian 13: one compiles, the other holds the program and the libraries that it links to.
FROM debian:trixie-slim AS build
COPY docker/install-deps /usr/local/sbin/install-deps
RUN install-deps build
WORKDIR /orbis
COPY . .
RUN cmake --preset release -DORBIS_TESTS=OFF \
 && cmake --build --preset release --target orbis \
 && strip build/orbis

FROM debian:trixie-slim
COPY docker/install-deps /usr/local/sbin/install-deps
RUN install-deps runtime && rm -rf /var/lib/apt/lists/* /var/cache/apt/* /var/log/apt /var/log/dpkg.log
# Jobs and results lie in /data, the only place that is written besides /tmp.
RUN useradd --uid 10001 --user-group --no-create-home --home-dir /data --shell /usr/sbin/nologin orbis \
 && install --directory --owner=orbis --group=orbis --mode=750 /data
COPY --from=build /orbis/build/orbis /usr/local/bin/orbis
# A shared library that is missing shows here, not in production.
RUN orbis --version
USER 10001:10001
VOLUME /data
EXPOSE 8080
STOPSIGNAL SIGTERM
# bash speaks TCP by itself: no curl in the image for the sake of the probe.
HEALTHCHECK --interval=10s --timeout=3s --start-period=10s --retries=3 \
  CMD ["bash", "-c", "exec 3<>/dev/tcp/127.0.0.1/8080 && printf 'GET /livez HTTP/1.0\\r\\n\\r\\n' >&3 && read -r _ status _ <&3 && [ \"$status\" = 200 ]"]
ENTRYPOINT ["orbis"]
CMD ["serve", "--host", "0.0.0.0", "--port", "8080", "--data", "/data"]
