# radhar with PyTorch for the CPU, as a user without rights, in the folder /data.
#
#   docker build -t radhar .
#   docker run --rm -v "$PWD:/data" --user "$(id -u)" radhar generate quickstart -o quickstart
FROM python:3.13-slim AS build
ARG EXTRAS=train,view,formats
WORKDIR /source
COPY . .
RUN python -m venv /opt/radhar \
    && /opt/radhar/bin/pip install --no-cache-dir -c constraints.txt \
        --extra-index-url https://download.pytorch.org/whl/cpu ".[${EXTRAS}]"

FROM python:3.13-slim
COPY --from=build /opt/radhar /opt/radhar
RUN useradd --uid 1000 --create-home radhar \
    && install --directory --owner radhar --mode 1777 /data
# Caches have a place whoever `--user` names, who may have no home.
ENV PATH=/opt/radhar/bin:$PATH MPLCONFIGDIR=/tmp NUMBA_CACHE_DIR=/tmp
USER 1000
WORKDIR /data
VOLUME /data
HEALTHCHECK --interval=60s --timeout=20s CMD ["radhar", "--version"]
ENTRYPOINT ["radhar"]
CMD ["--help"]
